// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/frame_file.hpp"

#include "core/base/concat.hpp"
#include "core/io/image_file.hpp"

namespace bpa::io {
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
    return invalid_argument("depth image ", depth_path, " is ", depth->width, "x", depth->height,
                            "; it must be ", frame.camera.width, "x", frame.camera.height,
                            " as the camera");
  }
  if (!color_path.empty()) {
    Result<ColorImage> color = read_color_image(color_path);
    if (!color.ok()) return color.status();
    if (color->width != depth->width || color->height != depth->height) {
      return invalid_argument("depth image ", depth_path, " is ", depth->width, "x", depth->height,
                              "; it must have the size of the colour image, ", color->width, "x",
                              color->height);
    }
    frame.color = std::move(color->pixels);
  }
  for (const std::uint16_t units : depth->pixels) {
    frame.depth.push_back(static_cast<float>(units * depth_scale_mm * 0.001));
  }
  return frame;
}

}  // namespace bpa::io
