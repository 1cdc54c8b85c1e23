// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/search.hpp"

#include <CLI/CLI.hpp>

#include "core/pipeline/score_layer_file.hpp"
#include "tools/detection_files.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {

void add_detector_options(CLI::App& command, DetectorArguments& arguments) {
  add_library_option(command, arguments.library);
  command.add_option("--config", arguments.config, "Settings of the detector (detector.yaml)")
      ->type_name("FILE");
}

Result<Detector> open_detector(const DetectorArguments& arguments, int num_threads) {
  Result<DetectorOptions> options = DetectorOptions();
  if (!arguments.config.empty()) options = load_detector_options(arguments.config);
  if (!options.ok()) return options.status();
  const auto library = load_detection_library(arguments.library, arguments.models, num_threads);
  if (!library.ok()) return library.status();
  Result<ScoreLayers> layers =
      arguments.built_in_layers ? default_score_layers() : library_score_layers(arguments.library);
  if (!layers.ok()) return layers.status();
  return Detector(*library, *options, std::move(*layers));
}

Status search_frames(const Detector& detector, const DatasetOptions& dataset,
                     const CommonOptions& common,
                     const std::function<void(const SearchedFrame&)>& use) {
  const auto frames = io::read_bop_frames(dataset.folder, dataset.split, dataset.scenes);
  if (!frames.ok()) return frames.status();
  DetectRequest request;
  request.seed = common.seed;
  request.num_threads = common.threads;
  Progress progress("frames", static_cast<int>(frames->size()));
  for (std::size_t i = 0; i < frames->size(); ++i) {
    progress.show(static_cast<int>(i));
    const io::BopFrame& entry = (*frames)[i];
    if (!entry.has_truth) continue;
    Result<Frame> frame = io::load_bop_frame(entry);
    if (!frame.ok()) return frame.status();
    clean_depth(*frame);
    FrameTrace trace;
    const auto result = detector.detect(*frame, request, &trace);
    if (!result.ok()) return result.status();
    use({i, entry.truth, *result, trace});
  }
  return {};
}

}  // namespace bpa::cli
