// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/detection_files.hpp"

#include <algorithm>

#include "core/io/model_file.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

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
  io::FrameResult result{scene, scene_id, im_id, seconds, {}};
  for (Interpretation& interpretation : result.interpretations) {
    for (Placement& placement : interpretation.placements) {
      placement = transformed(reported_from_camera, placement);
    }
  }
  return result;
}

}  // namespace bpa::cli
