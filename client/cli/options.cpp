// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/options.hpp"

#include <iostream>

#include "client/cli/convert.hpp"
#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/geometry/lens.hpp"
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
                     "its camera: fx fy cx cy and depth_scale (mm), or any form that bpa reads");
  command.add_option("--roi", files.roi, "part of each frame to search: x y width height")
      ->expected(4)
      ->check(CLI::NonNegativeNumber);
  command.add_option("--mask", files.mask,
                     "8-bit PNG of the frames' size; where it is black, they are not searched");
}

void add_priors_option(CLI::App& command, std::string& path) {
  command.add_option(
      "--priors", path,
      "what is known beforehand of the objects' poses, in the camera's frame: JSON, {\"priors\": "
      "[{\"model\": NAME, \"pose\": {\"rotation_wxyz\": [4], \"translation_m\": [3]}, "
      "\"position_sigma_m\": S, \"rotation_sigma_deg\": S, \"weight\": W}]}");
}

std::vector<ExpectedPose> read_priors(const std::string& path) {
  std::vector<ExpectedPose> expected;
  for (const PosePrior& prior : or_throw(io::read_pose_priors(path))) {
    expected.push_back(to_expected_pose(prior));
  }
  return expected;
}

void check_frame_options(const char* command, const FrameFiles& files, bool needed) {
  const bool pngs = !files.depth.empty() || !files.color.empty() || !files.camera.empty();
  if (!files.bop.empty() && pngs) {
    throw CLI::ValidationError(command, "give either --bop or --depth, --color and --camera");
  }
  if (pngs && (files.depth.empty() || files.camera.empty())) {
    throw CLI::ValidationError(command, "--depth and --camera are both needed");
  }
  if (needed && files.bop.empty() && !pngs) {
    throw CLI::ValidationError(command, "give --bop DATASET, or --depth F --camera F [--color F]");
  }
  if (files.empty() && !(files.roi.empty() && files.mask.empty())) {
    throw CLI::ValidationError(command, "--roi and --mask need frames from disk");
  }
}

std::vector<io::BopFrame> list_frames(const FrameFiles& files) {
  if (!files.bop.empty()) {
    return or_throw(io::read_bop_frames(files.bop, files.split, files.scenes));
  }
  const io::CameraFile camera = or_throw(io::read_camera(files.camera));
  for (const std::string& note : io::notes_of(camera, "is taken out of the images")) {
    std::cerr << files.camera << ": " << note << '\n';
  }
  io::BopFrame frame;
  frame.camera = camera.camera;
  frame.lens = or_throw(lens_of(camera.distortion_model, camera.distortion), files.camera);
  frame.depth_scale_mm = camera.depth_scale_mm;
  frame.depth_path = files.depth;
  frame.color_path = files.color;
  return {frame};
}

Frame load_frame(const io::BopFrame& entry, const FrameFiles& files, std::int64_t stamp_ns) {
  Frame frame = or_throw(io::load_bop_frame(entry));
  frame.stamp_ns = stamp_ns;
  if (!files.roi.empty()) frame.roi = {files.roi[0], files.roi[1], files.roi[2], files.roi[3]};
  if (files.mask.empty()) return frame;
  const io::ColorImage image = or_throw(io::read_color_image(files.mask));
  const Camera& camera = frame.camera;
  if (image.width != camera.width || image.height != camera.height) {
    throw Failure(invalid_argument(files.mask, " is ", image.width, "x", image.height,
                                   " but the frame is ", camera.width, "x", camera.height,
                                   "; they must be equal"));
  }
  for (auto pixel = image.pixels.begin(); pixel != image.pixels.end(); pixel += 3) {
    frame.mask.push_back(pixel[0] != 0 || pixel[1] != 0 || pixel[2] != 0);
  }
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
