// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/draw/html_page.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/pipeline/frame_trace.hpp"
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
  const ScoreLayers& layers;  ///< That the frame was searched with.
  const std::vector<io::BopInstance>& truth;
};

/// The stages that a model's hypotheses go through.
std::vector<std::string> stage_names();

/// Writes pictures and page sections of what became of one model in one frame.
class ModelExplanation {
 public:
  /// `index` counts FrameTrace::models; pictures go to `folder`. Nothing is owned.
  ModelExplanation(const ExplainedFrame& frame, std::size_t index, std::string folder);

  /// Pictures 03 and on, and what the page says of them.
  Status write(draw::HtmlPage& page) const;

  /// The model's row of a table: how many are alive after each of stage_names(), the probability of
  /// the best and whether the best interpretation holds it.
  std::vector<std::string> summary() const;

 private:
  bool is_reported() const;
  std::string verdict() const;
  std::size_t count_right(const TraceStage& stage) const;
  void write_table(draw::HtmlPage& page) const;
  Status write_stage(std::size_t index, draw::HtmlPage& page) const;
  Status write_best(draw::HtmlPage& page) const;
  void write_layer(draw::HtmlPage& page) const;

  const ExplainedFrame& frame_;
  const ObjectModel& model_;
  const ObjectTrace& trace_;
  std::string folder_;
  std::vector<Pose> truths_;
  const Candidate* best_ = nullptr;  ///< Null: no placement was good enough.
};

}  // namespace bpa::cli
