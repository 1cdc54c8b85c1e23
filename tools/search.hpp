// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/io/bop_dataset.hpp"
#include "core/pipeline/detector.hpp"
#include "tools/command.hpp"

namespace bpa::cli {

/// What a detector is made of.
struct DetectorArguments {
  std::string library;              ///< Folder of the models.
  std::string config;               ///< YAML file of settings; empty: the defaults.
  std::vector<std::string> models;  ///< Names; empty: all of the library.
  bool built_in_layers = false;     ///< Ignore score layers that the library has learned.
};

/// Adds --library and --config.
void add_detector_options(CLI::App& command, DetectorArguments& arguments);

/// Reads settings, models and the library's score layers, with a progress bar.
Detector open_detector(const DetectorArguments& arguments, int num_threads);

/// A frame with truth; nothing is owned.
struct TrueFrame {
  std::size_t index;   ///< Among all frames of the split, from 0.
  const Frame& frame;  ///< Its depth is clean.
  const std::vector<io::BopInstance>& truth;
};

/// Reads the frames of a split that have truth, with a progress bar, and hands over each.
void read_true_frames(const DatasetOptions& dataset,
                      const std::function<void(const TrueFrame&)>& use);

/// The same for frames that the detector has searched.
using UseSearched =
    std::function<void(const TrueFrame&, const SceneInterpretations&, const FrameTrace&)>;
void search_frames(const Detector& detector, const DatasetOptions& dataset,
                   const CommonOptions& common, const UseSearched& use);

}  // namespace bpa::cli
