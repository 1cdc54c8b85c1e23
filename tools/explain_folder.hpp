// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/pipeline/detector.hpp"
#include "core/result/interpretation.hpp"
#include "core/score/score_layer.hpp"

namespace bpa::cli {

/// A searched frame; what is referred to is not owned.
struct ExplainedFrame {
  std::string title;  ///< For people.
  std::string name;   ///< Of its folder where there are several frames.
  const Frame& frame;
  const FrameTrace& trace;
  const SceneInterpretations& result;
  const score::ScoreLayers& layers;  ///< That the frame was searched with.
  const std::vector<io::BopInstance>& truth;
};

/// Writes what happened to frames as pictures and pages, for bpa detect --explain:
///
///   index.html             the stages with counts and times, what each picture is
///   01_edges.png, 02_super_pixels.png           of the frame
///   03_sampled.png ... 14_final.png             the hypotheses after each stage of the detector
///   15_best.png, 16_best_segments.png           the best placement and its super-pixels;
///                                               the page has a table of its score components.
///
/// Several frames have a folder each, several models one each for 03 to 14; index.html leads there.
class ExplainFolder {
 public:
  ExplainFolder(std::string folder, bool several_frames)
      : folder_(std::move(folder)), several_frames_(several_frames) {}

  /// Folders are made as needed. Throws a Failure where that is not possible.
  void add(const ExplainedFrame& frame);
  /// Writes the page that leads to the frames, where there are several.
  void finish() const;

 private:
  std::string folder_;
  bool several_frames_;
  std::vector<std::vector<std::string>> frames_;  ///< The rows of the page.
};

}  // namespace bpa::cli
