// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/frame_file.hpp"

#include "core/io/image_file.hpp"

namespace bpa::io {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

Result<Frame> read_frame(const std::string& depth_path, const std::string& color_path,
                         const Camera& camera, double depth_scale_mm) {
  const Result<GrayImage> depth = read_gray_png(depth_path);
  if (!depth.ok()) return depth.status();
  Frame frame;
  frame.camera = camera;
  if (camera.width == 0 && camera.height == 0) {
    frame.camera.width = depth->width;
    frame.camera.height = depth->height;
  }
  if (Status status = validate(frame.camera); !status.ok()) return status;
  if (depth->width != frame.camera.width || depth->height != frame.camera.height) {
    return invalid_argument("depth image " + depth_path + " is " +
                            size_text(depth->width, depth->height) + "; it must be " +
                            size_text(frame.camera.width, frame.camera.height) + " as the camera");
  }
  if (!color_path.empty()) {
    Result<ColorImage> color = read_color_image(color_path);
    if (!color.ok()) return color.status();
    if (color->width != depth->width || color->height != depth->height) {
      return invalid_argument(
          "depth image " + depth_path + " is " + size_text(depth->width, depth->height) +
          "; it must have the size of the colour image, " + size_text(color->width, color->height));
    }
    frame.color = std::move(color->pixels);
  }
  frame.depth.resize(depth->pixels.size());
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    frame.depth[i] = static_cast<float>(depth->pixels[i] * depth_scale_mm * 0.001);
  }
  return frame;
}

}  // namespace bpa::io
