// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa calibrate: where several cameras are, by a board or by objects that they see.
#include <cstdio>
#include <filesystem>

#include "core/calibration/board.hpp"
#include "core/calibration/object_poses.hpp"
#include "core/calibration/surface_alignment.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/camera_poses_file.hpp"
#include "core/io/image_file.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace fs = std::filesystem;
namespace {

struct CalibrateArguments {
  DetectArguments frames;  ///< Of objects.
  CommonOptions common;
  std::vector<std::string> images, cameras, names;
  std::vector<int> corners;
  double square_mm = 0;
  bool no_surfaces = false;
  double min_probability = 0.7;
  std::string out;
};

std::string camera_name(const CalibrateArguments& a, std::size_t index,
                        const std::string& otherwise) {
  return a.names.empty() ? otherwise : a.names.at(index);
}

void check_names(const CalibrateArguments& a, std::size_t cameras) {
  if (a.names.empty() || a.names.size() == cameras) return;
  throw CLI::ValidationError(
      "--names", "needs a name for each of the " + std::to_string(cameras) + " cameras");
}

void calibrate_by_board(const CalibrateArguments& a) {
  if (a.cameras.size() != 1 && a.cameras.size() != a.images.size()) {
    throw CLI::ValidationError("--camera", "needs one file, or one for each image");
  }
  check_names(a, a.images.size());
  const calibration::Board board{a.corners[0], a.corners[1], a.square_mm / 1000};
  or_throw(validate(board));
  std::vector<io::CameraPose> found;
  for (std::size_t i = 0; i < a.images.size(); ++i) {
    const std::string& path = a.images[i];
    io::CameraFile file = or_throw(io::read_camera(a.cameras[a.cameras.size() == 1 ? 0 : i]));
    const io::ColorImage image = or_throw(io::read_color_image(path));
    if (file.camera.width == 0) {
      file.camera.width = image.width;
      file.camera.height = image.height;
    }
    const calibration::BoardPose pose = or_throw(
        calibration::find_board(image.pixels, file.camera, or_throw(io::plumb_bob_of(file)), board),
        path);
    found.push_back(
        {camera_name(a, i, fs::path(path).stem().string()), pose.camera_from_board.inverse()});
    const Eigen::Vector3d& t = found.back().scene_from_camera.translation;
    std::printf("%s: at %.3f %.3f %.3f m in the board's frame; residual %.2f pixels\n",
                found.back().name.c_str(), t.x(), t.y(), t.z(), pose.residual_px);
  }
  or_throw(io::write_camera_poses(a.out, found));
}

/// What all cameras see, and the surfaces of the first moment.
struct Moments {
  std::vector<std::vector<calibration::SeenObjects>> seen;
  std::vector<SurfaceMap> surfaces;
  std::vector<std::string> names;  ///< Of the cameras.
  Pose first;                      ///< The pose of the first camera; identity if not known.
};

Moments see_objects(const CalibrateArguments& a, const Detector& detector) {
  const std::vector<io::BopFrame> entries = list_inputs(a.frames);
  DetectRequest request = request_of(a.common);
  request.models = a.frames.detector.models;
  Moments out;
  if (entries.front().camera_from_world) out.first = entries.front().camera_from_world->inverse();
  Progress progress("frames", static_cast<int>(entries.size()));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    progress.show(static_cast<int>(i));
    if (i == 0 || entries[i].scene_id != entries[i - 1].scene_id) out.seen.emplace_back();
    const Input input = read_input(a.frames, entries[i]);
    FrameTrace trace;
    const SceneInterpretations result =
        or_throw(detector.detect(input.frame, request, &trace), input.name);
    calibration::SeenObjects& seen = out.seen.back().emplace_back();
    for (const Placement& placement : result.interpretations.front().placements) {
      if (placement.probability >= a.min_probability) seen.push_back(placement);
    }
    if (out.seen.size() > 1) continue;
    out.surfaces.push_back(std::move(trace.scene.map));
    out.names.push_back(camera_name(a, i, fs::path(entries[i].depth_path).stem().string()));
  }
  return out;
}

void calibrate_by_objects(const CalibrateArguments& a) {
  if (count_inputs(a.frames) != 1) {
    throw CLI::ValidationError("frames", "give one of --pcd, --depth (with --camera) and --bop");
  }
  const Detector detector = open_detector(a.frames.detector, a.common.threads);
  const Moments moments = see_objects(a, detector);
  check_names(a, moments.names.size());
  const std::vector<calibration::CameraByObjects> cameras =
      or_throw(calibration::cameras_from_objects(
          moments.seen,
          [&](const std::string& model) { return detector.library().find(model)->symmetry; },
          moments.first));
  std::vector<calibration::PosedSurface> surfaces;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    surfaces.push_back({&moments.surfaces[c], cameras[c].scene_from_camera});
    if (c == 0) continue;
    std::printf("%s: %d objects, residual %.1f mm and %.2f degrees\n", moments.names[c].c_str(),
                cameras[c].objects, 1000 * cameras[c].position_m, kDegrees * cameras[c].angle_rad);
  }
  std::vector<io::CameraPose> found;
  calibration::SurfaceAlignmentOptions options;
  if (a.no_surfaces) options.iterations = 1;
  const calibration::SurfaceAlignment aligned = calibration::align_surfaces(surfaces, options);
  // The first camera stays where it is.
  const Pose back = moments.first * aligned.scene_from_camera[0].inverse();
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    found.push_back({moments.names[c], a.no_surfaces ? cameras[c].scene_from_camera
                                                     : back * aligned.scene_from_camera[c]});
    surfaces[c].scene_from_camera = found[c].scene_from_camera;
  }
  std::vector<bool> compared(found.size(), false);
  for (const calibration::SurfaceDisagreement& pair : calibration::align_surfaces(surfaces).pairs) {
    compared[pair.first] = compared[pair.second] = true;
    std::printf(
        "%s and %s: median distance of their surfaces %.1f mm; %.1f mm and %.2f degrees "
        "from where they agree best\n",
        found[pair.first].name.c_str(), found[pair.second].name.c_str(), 1000 * pair.residual_m,
        1000 * pair.position_m, kDegrees * pair.angle_rad);
  }
  for (std::size_t c = 0; c < found.size(); ++c) {
    if (compared[c]) continue;
    print_warnings(found[c].name, {"its surface agrees with that of no other camera: the pose is "
                                   "wrong unless the views have nothing in common"});
  }
  or_throw(io::write_camera_poses(a.out, found));
}

void add_output(CLI::App& command, CalibrateArguments& a) {
  add_option(command, "--names", a.names, "Names of the cameras; those of the files if not given",
             "LIST")
      ->delimiter(',');
  add_option(command, "--out", a.out,
             "JSON file to write: scene_from_camera of each camera, for bpa detect --poses", "FILE")
      ->required();
}

void add_board(CLI::App& calibrate) {
  const auto [command, a] = add_command(
      calibrate, "board", "One image of the same chessboard from each camera", calibrate_by_board);
  add_option(command, "--images", a.images, "8-bit PNG or JPEG of each camera", "FILE...")
      ->required();
  add_option(command, "--camera", a.cameras,
             "Camera file as of bpa detect, with distortion: one for all images, or one for each",
             "FILE...")
      ->required();
  add_option(command, "--corners", a.corners,
             "Inner corners of the board: COLUMNS,ROWS, one even and one odd", "COLUMNS,ROWS")
      ->delimiter(',')
      ->expected(2)
      ->required();
  add_option(command, "--square-mm", a.square_mm, "Edge of a square, millimetres", "MM")
      ->required();
  add_output(command, a);
}

void add_objects(CLI::App& calibrate) {
  const auto [command, a] =
      add_command(calibrate, "objects",
                  "Objects of a library that several cameras see. The fixed frame is the first "
                  "camera's, or that of its cam_R_w2c. Of a data set, each scene has one image "
                  "from each camera, in the same order",
                  calibrate_by_objects);
  add_input_options(command, a.frames);
  add_detector_options(command, a.frames.detector);
  add_option(command, "--min-probability", a.min_probability,
             "Less probable placements are not used")
      ->check(CLI::Range(0.0, 1.0));
  command.add_flag("--no-surfaces", a.no_surfaces,
                   "Do not align the surfaces of the frames after the objects");
  add_output(command, a);
}

}  // namespace

void add_calibrate_command(CLI::App& program) {
  CLI::App& calibrate =
      *program.add_subcommand("calibrate", "Where several cameras are, in one fixed frame");
  calibrate.require_subcommand(1);
  add_board(calibrate);
  add_objects(calibrate);
}

}  // namespace bpa::cli
