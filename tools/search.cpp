// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search.hpp"

#include <algorithm>
#include <cstdio>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/model_file.hpp"
#include "core/io/pcd_file.hpp"

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

Input read_pcd(const std::string& path, Camera camera) {
  const io::PcdCloud cloud = or_throw(io::read_pcd(path));
  if (camera.width == 0) {
    camera.width = cloud.width;
    camera.height = cloud.height;
  }
  const bool known = camera.fx != 0;
  io::OrganisedFrame organised =
      or_throw(io::frame_from_organised_cloud(cloud, known ? &camera : nullptr), path);
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
  add_option(command, "--pcd", a.pcd, "Organised PCD clouds; the camera is estimated from them",
             "FILE...");
  auto* const camera = add_option(
      command, "--camera", a.camera,
      "fx fy cx cy or a 3 x 3 matrix: BOP, ROS camera_info, Open3D, librealsense, OpenCV, "
      "bare numbers",
      "FILE");
  auto* const depth =
      add_option(command, "--depth", a.depth, "16-bit depth PNGs, registered to colour", "FILE...");
  depth->needs(camera);
  add_option(command, "--color", a.color, "8-bit colour PNGs of the same size", "FILE...")
      ->needs(depth);
  auto* const bop =
      add_option(command, "--bop", a.dataset.folder, "Folder of a BOP data set", "DIR");
  bop->excludes(camera);
  add_split_options(command, a.dataset);
  command.get_option("--scenes")->needs(bop);
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
  return Detector(library, read_detector_options(a.config),
                  or_throw(library_score_layers(a.library)));
}

std::vector<io::BopFrame> list_inputs(const DetectArguments& a) {
  const DatasetOptions& dataset = a.dataset;
  if (!dataset.folder.empty()) {
    return or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes));
  }
  io::BopFrame entry;
  if (!a.camera.empty()) {
    const io::CameraFile file = or_throw(io::read_camera(a.camera));
    print_notes(a.camera, io::notes_of(file));
    entry.camera = file.camera;
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
    input = read_pcd(entry.depth_path, entry.camera);
  } else {
    input.frame = or_throw(io::load_bop_frame(entry));
    input.frame.frame_id = std::to_string(entry.scene_id);  // one camera takes a scene's images
    input.name = a.dataset.folder.empty() ? entry.depth_path
                                          : "scene " + std::to_string(entry.scene_id) + " image " +
                                                std::to_string(entry.im_id);
  }
  return input;
}

Input read_input(const DetectArguments& a, const io::BopFrame& entry) {
  Input input = read_raw_input(a, entry);
  clean_depth(input.frame);
  return input;
}

DetectRequest request_of(const CommonOptions& common) {
  return {.seed = common.seed, .num_threads = common.threads};
}

void read_true_frames(const DatasetOptions& dataset,
                      const std::function<void(const TrueFrame&)>& use) {
  const auto frames = or_throw(io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes));
  Progress progress("frames", static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.show(static_cast<int>(i));
    if (!frames[i].has_truth) continue;
    Frame frame = or_throw(io::load_bop_frame(frames[i]));
    clean_depth(frame);
    use({i, frame, frames[i].truth});
  }
}

void search_frames(const Detector& detector, const DatasetOptions& dataset,
                   const CommonOptions& common, const UseSearched& use, int max_models) {
  DetectRequest request = request_of(common);
  std::vector<std::string> names;
  for (const auto& model : detector.library().models()) names.push_back(model->name);
  read_true_frames(dataset, [&](const TrueFrame& frame) {
    if (max_models > 0 && max_models < std::ssize(names)) {
      std::ranges::shuffle(names, RandomStream(common.seed, frame.index));
      request.models.assign(names.begin(), names.begin() + max_models);
    }
    FrameTrace trace;
    use(frame, or_throw(detector.detect(frame.frame, request, &trace)), trace);
  });
}

}  // namespace bpa::cli
