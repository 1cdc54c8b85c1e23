// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/detection_files.hpp"

#include <algorithm>

#include "core/io/model_file.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

io::ResultPlacement to_result(const Placement& placement, const Pose& reported_from_camera) {
  io::ResultPlacement result;
  result.obj_id = placement.model_number;
  result.model = placement.model;
  result.score = placement.score;
  result.probability = placement.probability;
  result.visible_fraction = placement.visible_fraction;
  for (const ScoreComponent& part : placement.components) {
    result.components.push_back({part.name, part.value});
  }
  for (const PoseAlternative& other : placement.alternatives) {
    result.alternatives.push_back({other.camera_from_object, other.weight});
  }
  result.camera_from_object = placement.camera_from_object;
  result.covariance = placement.covariance;
  result.orientation_axes = placement.orientation.axes;
  result.orientation_concentrations = placement.orientation.concentrations;
  const bool same =
      reported_from_camera.rotation.coeffs() == Eigen::Quaterniond::Identity().coeffs() &&
      reported_from_camera.translation.isZero(0);
  if (same) return result;  // to the last bit

  result.camera_from_object = reported_from_camera * placement.camera_from_object;
  for (io::ResultAlternative& other : result.alternatives) {
    other.camera_from_object = reported_from_camera * other.camera_from_object;
  }
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = reported_from_camera.matrix();
  turn.bottomRightCorner<3, 3>() = reported_from_camera.matrix();
  result.covariance = turn * placement.covariance * turn.transpose();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector4d axis = placement.orientation.axes.col(i);
    const Eigen::Quaterniond turned =
        reported_from_camera.rotation * Eigen::Quaterniond(axis[0], axis[1], axis[2], axis[3]);
    result.orientation_axes.col(i) = to_wxyz(turned);
  }
  return result;
}

/// The models of a library; a broken one is a failure only where it is asked for. No names: all.
Result<std::vector<ModelSource>> wanted_models(const std::string& folder,
                                               const std::vector<std::string>& names,
                                               int num_threads) {
  if (names.empty()) return io::load_library(folder, num_threads);
  Result<io::LibraryContents> contents = io::read_library(folder, num_threads);
  if (!contents.ok()) return contents.status();
  for (const io::BrokenModel& broken : contents->broken) {
    if (std::find(names.begin(), names.end(), broken.name) != names.end()) return broken.reason;
  }
  return std::move(contents->models);
}

}  // namespace

Result<std::shared_ptr<const ModelLibrary>> load_detection_library(
    const std::string& folder, const std::vector<std::string>& names, int num_threads) {
  Result<std::vector<ModelSource>> sources = wanted_models(folder, names, num_threads);
  if (!sources.ok()) return sources.status();
  for (const std::string& name : names) {
    const bool known = std::any_of(sources->begin(), sources->end(),
                                   [&name](const ModelSource& s) { return s.name == name; });
    if (!known) {
      return Status(StatusCode::not_found, "library " + folder + " has no model \"" + name + "\"");
    }
  }
  auto library = std::make_shared<ModelLibrary>();
  Progress progress("models", static_cast<int>(sources->size()));
  for (std::size_t i = 0; i < sources->size(); ++i) {
    ModelSource& source = (*sources)[i];
    progress.show(static_cast<int>(i), source.name);
    if (!names.empty() && std::find(names.begin(), names.end(), source.name) == names.end()) {
      continue;
    }
    const std::string name = source.name;
    Result<std::shared_ptr<const ObjectModel>> model =
        make_object_model(std::move(source), num_threads);
    if (!model.ok()) return Status(model.status().code, name + ": " + model.status().message);
    if (Status s = library->add(*model); !s.ok()) return s;
  }
  return std::shared_ptr<const ModelLibrary>(std::move(library));
}

io::FrameResult to_frame_result(const SceneInterpretations& scene, int scene_id, int im_id,
                                double seconds, const Pose& reported_from_camera) {
  io::FrameResult result;
  result.scene_id = scene_id;
  result.im_id = im_id;
  result.seconds = seconds;
  result.budget_exhausted = scene.budget_exhausted;
  result.fused_frames = scene.fused_frames;
  for (const StageTiming& timing : scene.timings) {
    result.timings.push_back({timing.stage, timing.milliseconds});
  }
  for (const Interpretation& interpretation : scene.interpretations) {
    io::ResultInterpretation item;
    item.rank = interpretation.rank;
    item.score = interpretation.score;
    item.probability = interpretation.probability;
    for (const Placement& placement : interpretation.placements) {
      item.placements.push_back(to_result(placement, reported_from_camera));
    }
    result.interpretations.push_back(std::move(item));
  }
  return result;
}

}  // namespace bpa::cli
