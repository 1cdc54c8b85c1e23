// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search.hpp"

#include <algorithm>
#include <cstdio>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/doctor/frame_check.hpp"
#include "core/eval/match_names.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/model_file.hpp"
#include "core/io/pcd_file.hpp"
#include "tools/mesh_input.hpp"

namespace bpa::cli {
namespace {

/// The models that the arguments name; reads no others.
std::vector<ModelSource> wanted_models(const DetectorArguments& a, int num_threads) {
  std::vector<std::string> names = a.models;
  if (names.empty()) return or_throw(io::load_library(a.library, num_threads));
  const std::vector<std::string> own = io::list_models(a.library);
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::vector<ModelSource> models(names.size());
  parallel_for(names.size(), num_threads, [&](std::size_t i) {
    const bool is_own = a.further.empty() || std::ranges::binary_search(own, names[i]);
    models[i] = or_throw(io::load_model(is_own ? a.library : a.further, names[i]));
  });
  return models;
}

void print_notes(const std::string& path, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::printf("%s: %s\n", path.c_str(), note.c_str());
}

Input read_pcd(const std::string& path, Camera camera, double unit) {
  const io::PcdCloud cloud = or_throw(io::read_pcd(path));
  if (camera.width == 0) {
    camera.width = cloud.width;
    camera.height = cloud.height;
  }
  const bool known = camera.fx != 0;
  io::OrganisedFrame organised =
      or_throw(io::frame_from_organised_cloud(cloud, known ? &camera : nullptr, unit), path);
  print_notes(path, organised.notes);
  return {path, std::move(organised.frame), organised.cloud_from_camera};
}

}  // namespace

void add_detector_options(CLI::App& command, DetectorArguments& arguments) {
  add_library_option(command, arguments.library);
  add_option(command, "--config", arguments.config, "Settings of the detector (detector.yaml)",
             "FILE");
}

void add_input_options(CLI::App& command, DetectArguments& a) {
  auto* const pcd =
      add_option(command, "--pcd", a.pcd, "Organised PCD clouds; the camera is estimated from them",
                 "FILE...");
  add_unit_option(command, a.cloud_unit,
                  "Unit of the clouds; metres if not given, or millimetres where the median depth "
                  "is over 100")
      ->needs(pcd);
  auto* const camera = add_option(
      command, "--camera", a.camera,
      "fx fy cx cy or a 3 x 3 matrix: BOP, ROS camera_info, Open3D, librealsense, OpenCV, "
      "ORB-SLAM, NeRF, ini, bare numbers",
      "FILE");
  command
      .add_flag(
          "--rectified", a.rectified,
          "Images are rectified: take the camera's projection matrix P, if it has one, and no "
          "distortion")
      ->needs(camera);
  auto* const depth =
      add_option(command, "--depth", a.depth, "16-bit depth PNGs, registered to colour", "FILE...");
  depth->needs(camera);
  add_option(command, "--color", a.color,
             "Colour PNGs or JPEGs of the same size; grey ones are not compared by colour",
             "FILE...")
      ->needs(depth);
  auto* const bop =
      add_option(command, "--bop", a.dataset.folder, "Folder of a BOP data set", "DIR");
  bop->excludes(camera);
  add_split_options(command, a.dataset);
  command.get_option("--scenes")->needs(bop);
  add_option(command, "--images", a.images, "Images of each scene, such as 0,7; all if not given",
             "LIST")
      ->delimiter(',')
      ->needs(bop);
}

int count_inputs(const DetectArguments& a) {
  if (!a.color.empty() && a.color.size() != a.depth.size()) {
    throw CLI::ValidationError("--color", "needs as many files as --depth");
  }
  return !a.pcd.empty() + !a.depth.empty() + !a.dataset.folder.empty();
}

DetectorOptions read_detector_options(const std::string& config) {
  return config.empty() ? DetectorOptions() : or_throw(load_detector_options(config));
}

std::shared_ptr<const ModelLibrary> open_library(const DetectorArguments& a, int num_threads) {
  std::vector<ModelSource> sources = wanted_models(a, num_threads);
  const auto library = std::make_shared<ModelLibrary>();
  Progress progress("models", static_cast<int>(sources.size()));
  for (ModelSource& source : sources) {
    const std::string name = source.name;
    progress.show(library->size(), name);
    const auto model = or_throw(make_object_model(std::move(source), num_threads), name);
    or_throw(library->add(model));
  }
  return library;
}

Detector open_detector(const DetectorArguments& a, int num_threads) {
  const auto library = open_library(a, num_threads);
  DetectorOptions options = read_detector_options(a.config);
  if (a.min_probability) options.scene.min_probability = *a.min_probability;
  return Detector(library, options, or_throw(library_score_layers(a.library)));
}

std::vector<io::BopFrame> list_inputs(const DetectArguments& a) {
  const DatasetOptions& dataset = a.dataset;
  if (!dataset.folder.empty()) {
    auto frames = or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes));
    for (const int image : a.images) {
      if (std::ranges::count(frames, image, &io::BopFrame::im_id) > 0) continue;
      throw Failure(not_found(dataset.folder, " has no image ", image));
    }
    std::erase_if(frames, [&a](const io::BopFrame& frame) {
      return !a.images.empty() && std::ranges::count(a.images, frame.im_id) == 0;
    });
    return frames;
  }
  io::BopFrame entry;
  if (!a.camera.empty()) {
    const io::CameraFile file = or_throw(io::read_camera(a.camera));
    const bool undistorted = a.pcd.empty() && !a.rectified;
    print_notes(a.camera, io::notes_of(file, undistorted ? "is taken out of the images; they are "
                                                           "rectified already: --rectified"
                                                         : "is not used"));
    entry.camera = a.rectified ? file.rectified.value_or(file.camera) : file.camera;
    if (undistorted) {
      entry.lens = or_throw(lens_of(file.distortion_model, file.distortion), a.camera);
    }
    entry.depth_scale_mm = file.depth_scale_mm;
  }
  std::vector<io::BopFrame> entries;
  for (const std::string& path : a.pcd.empty() ? a.depth : a.pcd) {
    entry.im_id = static_cast<int>(entries.size());
    entry.depth_path = path;
    if (!a.color.empty()) entry.color_path = a.color[entries.size()];
    entries.push_back(entry);
  }
  return entries;
}

Input read_raw_input(const DetectArguments& a, const io::BopFrame& entry) {
  Input input;
  if (!a.pcd.empty()) {
    input = read_pcd(entry.depth_path, entry.camera, a.cloud_unit);
  } else {
    std::string note;
    input.frame = or_throw(io::load_bop_frame(entry, &note));
    if (!note.empty()) print_notes(entry.depth_path, {note});
    input.frame.frame_id = std::to_string(entry.scene_id);  // one camera takes a scene's images
    input.name = a.dataset.folder.empty() ? entry.depth_path
                                          : "scene " + std::to_string(entry.scene_id) + " image " +
                                                std::to_string(entry.im_id);
  }
  return input;
}

Input read_input(const DetectArguments& a, const io::BopFrame& entry) {
  Input input = read_raw_input(a, entry);
  or_throw(
      doctor::make_searchable(input.frame, DetectorOptions().surface.max_range_m, a.common.threads),
      input.name);
  return input;
}

DetectRequest request_of(const CommonOptions& common) {
  return {.seed = common.seed, .num_threads = common.threads};
}

void number_truth(const std::string& dataset, const ModelLibrary& library, bool whole,
                  std::vector<io::BopFrame>& frames) {
  eval::ModelNames known, truth;
  for (const auto& model : library.models()) known[model->number] = model->name;
  for (const io::BopFrame& frame : frames) {
    for (const io::BopInstance& instance : frame.truth) truth[instance.obj_id];
  }
  const auto models = io::read_bop_models(dataset);  // test sets may come without
  for (std::size_t i = 0; models.ok() && i < models->size(); ++i) {
    const auto object = truth.find((*models)[i].obj_id);
    if (object != truth.end()) object->second = (*models)[i].name;
  }
  const std::map<int, int> numbers = eval::matched(truth, known);
  std::string lacks;
  for (const auto& [number, name] : truth) {
    if (numbers.contains(number)) continue;
    lacks += (lacks.empty() ? "" : ", ") + (name.empty() ? io::bop_object_name(number) : name);
  }
  if (whole && !lacks.empty()) {
    print_warnings(dataset, {"the library lacks objects of its truth: " + lacks});
  }
  for (io::BopFrame& frame : frames) {
    for (io::BopInstance& instance : frame.truth) {
      const auto number = numbers.find(instance.obj_id);
      instance.obj_id = number != numbers.end() ? number->second : -1;
    }
  }
}

void read_true_frames(const DatasetOptions& dataset,
                      const std::function<void(const TrueFrame&)>& use,
                      const ModelLibrary* library) {
  auto frames = or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes));
  if (library != nullptr) number_truth(dataset.folder, *library, true, frames);
  Progress progress("frames", static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.show(static_cast<int>(i));
    if (!frames[i].has_truth) continue;
    Result<Frame> frame = io::load_bop_frame(frames[i]);
    if (!frame.ok()) {
      progress.clear();
      print_warnings("left out", {frame.status().message});
      continue;
    }
    clean_depth(*frame);
    use({i, *frame, frames[i].truth});
  }
}

void search_frames(const Detector& detector, const DatasetOptions& dataset,
                   const CommonOptions& common, const UseSearched& use, int max_models) {
  DetectRequest request = request_of(common);
  std::vector<std::string> names;
  for (const auto& model : detector.library().models()) names.push_back(model->name);
  read_true_frames(
      dataset,
      [&](const TrueFrame& frame) {
        if (max_models > 0 && max_models < std::ssize(names)) {
          std::ranges::shuffle(names, RandomStream(common.seed, frame.index));
          request.models.assign(names.begin(), names.begin() + max_models);
        }
        FrameTrace trace;
        use(frame, or_throw(detector.detect(frame.frame, request, &trace)), trace);
      },
      &detector.library());
}

}  // namespace bpa::cli
