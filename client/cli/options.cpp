// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/options.hpp"

#include "client/cli/convert.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/image_file.hpp"
#include "core/io/pose_prior_file.hpp"

namespace bpa::cli {

void add_frame_options(CLI::App& command, FrameFiles& files) {
  command.add_option("--bop", files.bop, "folder of a data set in the BOP layout");
  command.add_option("--split", files.split, "split of the data set")->capture_default_str();
  command.add_option("--scenes", files.scenes, "scene numbers; default all")->delimiter(',');
  command.add_option("--depth", files.depth, "16-bit PNG registered to the colour image");
  command.add_option("--color", files.color, "PNG of the same size");
  command.add_option("--camera", files.camera,
                     "BOP camera.json (fx fy cx cy, depth_scale in mm) or camera_info YAML");
}

void add_restriction_options(CLI::App& command, Restriction& restriction) {
  command.add_option("--roi", restriction.roi, "part of each frame to search: x y width height")
      ->expected(4)
      ->check(CLI::NonNegativeNumber);
  command.add_option("--mask", restriction.mask_path,
                     "8-bit PNG of the frames' size; where it is black, they are not searched");
}

Status Restriction::apply(Frame& frame) const {
  if (!roi.empty()) frame.roi = {roi[0], roi[1], roi[2], roi[3]};
  if (mask_path.empty()) return {};
  const auto image = io::read_color_image(mask_path);
  if (!image.ok()) return image.status();
  const Camera& camera = frame.camera;
  if (image->width != camera.width || image->height != camera.height) {
    return invalid_argument(mask_path + " is " + std::to_string(image->width) + "x" +
                            std::to_string(image->height) + " but the frame is " +
                            std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                            "; they must be equal");
  }
  for (auto pixel = image->pixels.begin(); pixel != image->pixels.end(); pixel += 3) {
    frame.mask.push_back(pixel[0] != 0 || pixel[1] != 0 || pixel[2] != 0);
  }
  return {};
}

void add_priors_option(CLI::App& command, std::string& path) {
  command.add_option(
      "--priors", path,
      "what is known beforehand of the objects' poses, in the camera's frame: JSON, {\"priors\": "
      "[{\"model\": NAME, \"pose\": {\"rotation_wxyz\": [4], \"translation_m\": [3]}, "
      "\"position_sigma_m\": S, \"rotation_sigma_deg\": S, \"weight\": W}]}");
}

Result<std::vector<ExpectedPose>> read_priors(const std::string& path) {
  const auto priors = io::read_pose_priors(path);
  if (!priors.ok()) return priors.status();
  std::vector<ExpectedPose> expected;
  for (const PosePrior& prior : *priors) expected.push_back(to_expected_pose(prior));
  return expected;
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

Result<std::vector<io::BopFrame>> list_frames(const FrameFiles& files) {
  if (!files.bop.empty()) return io::read_bop_frames(files.bop, files.split, files.scenes);
  const auto camera = io::read_camera(files.camera);
  if (!camera.ok()) return camera.status();
  io::BopFrame frame;
  frame.camera = camera->camera;
  frame.depth_scale_mm = camera->depth_scale_mm;
  frame.depth_path = files.depth;
  frame.color_path = files.color;
  return std::vector<io::BopFrame>{frame};
}

Result<Frame> load_frame(const io::BopFrame& entry, const Restriction& restriction,
                         std::int64_t stamp_ns) {
  Result<Frame> frame = io::load_bop_frame(entry);
  if (!frame.ok()) return frame;
  frame->stamp_ns = stamp_ns;
  if (Status status = restriction.apply(*frame); !status.ok()) return status;
  return frame;
}

Status write_annotated(const std::string& folder, const AnnotatedImage& image) {
  const auto [scene, number] = scene_and_image(image.frame_id);
  const std::string name = scene != 0 || number != 0
                               ? io::bop_number(scene) + "_" + io::bop_number(number)
                               : std::to_string(image.stamp_ns);
  return io::write_color_png(folder + "/" + name + ".png", {image.width, image.height, image.rgb});
}

}  // namespace bpa::cli
