// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search.hpp"

#include <algorithm>

#include "core/io/model_file.hpp"
#include "core/pipeline/detector.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

/// The models of a library; a broken one is a failure only where it is asked for. No names: all.
std::vector<ModelSource> wanted_models(const std::string& folder,
                                       const std::vector<std::string>& names, int num_threads) {
  if (names.empty()) return or_throw(io::load_library(folder, num_threads));
  io::LibraryContents contents = or_throw(io::read_library(folder, num_threads));
  std::vector<ModelSource>& models = contents.models;
  for (const io::BrokenModel& broken : contents.broken) {
    if (std::ranges::count(names, broken.name) > 0) or_throw(broken.reason);
  }
  for (const std::string& name : names) {
    if (std::ranges::count(models, name, &ModelSource::name) > 0) continue;
    throw Failure({StatusCode::not_found, "library " + folder + " has no model \"" + name + "\""});
  }
  std::erase_if(
      models, [&](const ModelSource& model) { return std::ranges::count(names, model.name) == 0; });
  return std::move(models);
}

}  // namespace

void add_detector_options(CLI::App& command, DetectorArguments& arguments) {
  add_library_option(command, arguments.library);
  add_option(command, "--config", arguments.config, "Settings of the detector (detector.yaml)",
             "FILE");
}

Detector open_detector(const DetectorArguments& a, int num_threads) {
  const DetectorOptions options =
      a.config.empty() ? DetectorOptions() : or_throw(load_detector_options(a.config));
  std::vector<ModelSource> sources = wanted_models(a.library, a.models, num_threads);
  const auto library = std::make_shared<ModelLibrary>();
  Progress progress("models", static_cast<int>(sources.size()));
  for (ModelSource& source : sources) {
    const std::string name = source.name;
    progress.show(library->size(), name);
    const auto model = or_throw(make_object_model(std::move(source), num_threads), name);
    or_throw(library->add(model));
  }
  return Detector(
      library, options,
      a.built_in_layers ? default_score_layers() : or_throw(library_score_layers(a.library)));
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
                   const CommonOptions& common, const UseSearched& use) {
  DetectRequest request;
  request.seed = common.seed;
  request.num_threads = common.threads;
  read_true_frames(dataset, [&](const TrueFrame& frame) {
    FrameTrace trace;
    use(frame, or_throw(detector.detect(frame.frame, request, &trace)), trace);
  });
}

}  // namespace bpa::cli
