// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/options.hpp"

#include <cstdio>
#include <filesystem>

#include "client/cli/output.hpp"
#include "client/cli/png_file.hpp"

namespace bpa::cli {

void add_frame_options(CLI::App& command, FrameFiles& files) {
  command.add_option("--bop", files.bop, "folder of a data set in the BOP layout");
  command.add_option("--split", files.split, "split of the data set")->capture_default_str();
  command.add_option("--scenes", files.scenes, "scene numbers; default all")->delimiter(',');
  command.add_option("--depth", files.depth, "16-bit PNG registered to the colour image");
  command.add_option("--color", files.color, "PNG of the same size");
  command.add_option("--camera", files.camera, "BOP camera.json: fx fy cx cy, depth_scale (mm)");
}

void add_restriction_options(CLI::App& command, Restriction& restriction) {
  command.add_option("--roi", restriction.roi, "part of each frame to search: x y width height")
      ->expected(4)
      ->check(CLI::NonNegativeNumber);
  command.add_option("--mask", restriction.mask_path,
                     "8-bit PNG of the frames' size; where it is black, they are not searched");
}

Status Restriction::load() {
  if (mask_path.empty()) return {};
  const auto image = read_color_png(mask_path);
  if (!image.ok()) return image.status();
  mask_width = image->width;
  mask_height = image->height;
  mask.clear();
  for (std::size_t i = 0; i + 2 < image->rgb.size(); i += 3) {
    mask.push_back(image->rgb[i] != 0 || image->rgb[i + 1] != 0 || image->rgb[i + 2] != 0);
  }
  return {};
}

Status Restriction::apply(FrameView& frame) const {
  if (!roi.empty()) frame.roi = {{roi[0], roi[1], roi[2], roi[3]}};
  if (mask.empty()) return {};
  if (mask_width != frame.width || mask_height != frame.height) {
    return invalid_argument(mask_path + " is " + std::to_string(mask_width) + "x" +
                            std::to_string(mask_height) + " but the frame is " +
                            std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                            "; they must be equal");
  }
  frame.mask = mask.data();
  return {};
}

void add_sink_options(CLI::App& command, Sinks& sinks) {
  command.add_option("--json", sinks.json, "write all results to this file");
  command.add_option("--annotated", sinks.annotated, "write annotated images to this folder");
  command.add_option("--top", sinks.top, "interpretations to print for each frame")
      ->capture_default_str();
}

Status check_frame_options(const FrameFiles& files, bool needed) {
  const bool pngs = !files.depth.empty() || !files.color.empty() || !files.camera.empty();
  if (!files.bop.empty() && pngs) {
    return invalid_argument("give either --bop or --depth, --color and --camera");
  }
  if (pngs && (files.depth.empty() || files.camera.empty())) {
    return invalid_argument("--depth and --camera are both needed");
  }
  if (needed && files.bop.empty() && !pngs) {
    return invalid_argument("give --bop DATASET, or --depth F --camera F [--color F]");
  }
  return {};
}

Status write_annotated(const std::string& folder, const AnnotatedImage& image) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto [scene, number] = scene_and_image(image.frame_id);
  char name[64];
  if (scene != 0 || number != 0) {
    std::snprintf(name, sizeof name, "%06d_%06d.png", scene, number);
  } else {
    std::snprintf(name, sizeof name, "%lld.png", static_cast<long long>(image.stamp_ns));
  }
  return write_png((std::filesystem::path(folder) / name).string(), image.width, image.height,
                   image.rgb);
}

}  // namespace bpa::cli
