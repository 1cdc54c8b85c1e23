// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/explain_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "core/detect/stages.hpp"
#include "core/draw/number.hpp"
#include "core/draw/poses.hpp"
#include "core/draw/scene_features.hpp"
#include "core/draw/sheet.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/io/image_file.hpp"
#include "core/score/predicted_surface.hpp"
#include "core/score/segment_scores.hpp"

namespace bpa::cli {
namespace {

using draw::DrawnPoses;
using draw::fixed;
using draw::HtmlPage;
using draw::LegendEntry;
using draw::Rgb;
using Row = std::vector<std::string>;

constexpr Rgb kAlive{80, 255, 120}, kTrue{255, 255, 255};
constexpr Rgb kRejected[] = {
    {235, 75, 65}, {245, 165, 40}, {200, 100, 230}, {90, 150, 255}, {165, 165, 165}};

/// More poses are dots in a picture: of those alive alone, and of all together.
constexpr std::size_t kMaxOutlinedAlive = 250, kMaxOutlined = 80;
constexpr std::string_view kOutlines =
    " An outline is the model at one pose, the best ones brightest; a dot is its middle.";
constexpr std::string_view kDots = " A dot is the middle of the model at one pose.";

std::string numbered(int number, std::string_view name) {
  char text[16];
  std::snprintf(text, sizeof text, "%02d_", number);
  return text + std::string(name) + ".png";
}

bool is_right(const FastPose& pose, const std::vector<Pose>& truths,
              const SymmetryGroup& symmetry) {
  return std::any_of(truths.begin(), truths.end(), [&](const Pose& truth) {
    return eval::is_right(to_pose(pose), truth, symmetry);
  });
}

}  // namespace

Row stage_names() {
  Row names;
  for (const Stage& stage : detection_stages()) names.emplace_back(stage.name);
  return names;
}

ModelExplanation::ModelExplanation(const ExplainedFrame& frame, std::size_t index,
                                   std::string folder)
    : frame_(frame),
      model_(*frame.trace.models[index]),
      trace_(frame.trace.objects[index]),
      folder_(std::move(folder)) {
  for (const io::BopInstance& instance : frame.truth) {
    if (instance.obj_id == model_.number) truths_.push_back(instance.camera_from_object);
  }
  for (const Candidate& candidate : frame.trace.candidates) {
    if (candidate.model != &model_) continue;
    if (!best_ || candidate.score > best_->score) best_ = &candidate;
  }
}

Status ModelExplanation::write(HtmlPage& page) const {
  if (frame_.result.budget_exhausted) {
    page.paragraph("The time budget was exhausted: the search stopped with what it had.");
  }
  page.paragraph(verdict());
  write_table(page);
  for (std::size_t i = 0; i < trace_.stages.size(); ++i) {
    if (Status status = write_stage(i, page); !status.ok()) return status;
  }
  return best_ ? write_best(page) : Status();
}

Row ModelExplanation::summary() const {
  Row row = {HtmlPage::link(model_.name + "/index.html", model_.name)};
  for (const auto& stage : trace_.stages) row.push_back(std::to_string(stage.poses.size()));
  row.resize(1 + detection_stages().size());
  row.push_back(best_ ? fixed(best_->probability, 2) : "");
  row.push_back(is_reported() ? "yes" : "");
  return row;
}

bool ModelExplanation::is_reported() const {
  if (!best_ || frame_.result.interpretations.empty()) return false;
  const auto& placements = frame_.result.interpretations.front().placements;
  return std::any_of(placements.begin(), placements.end(), [&](const Placement& p) {
    return p.model == model_.name && p.camera_from_object.translation == best_->pose().translation;
  });
}

std::string ModelExplanation::verdict() const {
  std::string text;
  if (!best_) {
    text = "No placement was good enough.";
  } else {
    const Eigen::Vector3d& t = best_->pose().translation;
    text = "The best placement is at (" + fixed(t.x(), 3) + ", " + fixed(t.y(), 3) + ", " +
           fixed(t.z(), 3) + ") m in the camera's frame. Its probability among its rivals is " +
           fixed(best_->probability, 2) + ", so that the best interpretation of the scene " +
           (is_reported() ? "holds it." : "does not hold it.");
  }
  if (!frame_.truth.empty()) {
    text += truths_.empty() ? " The model is not truly there."
                            : " It is truly there " + std::to_string(truths_.size()) +
                                  (truths_.size() == 1 ? " time" : " times") +
                                  " (dashed in white); right means within 2.5 cm and pi/16.";
  }
  return text;
}

std::size_t ModelExplanation::count_right(const TraceStage& stage) const {
  return static_cast<std::size_t>(std::count_if(
      stage.poses.begin(), stage.poses.end(),
      [&](const FastPose& pose) { return is_right(pose, truths_, model_.symmetry); }));
}

void ModelExplanation::write_table(HtmlPage& page) const {
  Row head = {"stage", "alive", "rejected", "milliseconds"};
  if (!truths_.empty()) head.push_back("right ones alive");
  std::vector<Row> rows;
  for (const auto& stage : trace_.stages) {
    std::string rejected;
    for (const Rejected& r : stage.rejected) {
      rejected += (rejected.empty() ? "" : "<br>") + std::to_string(r.poses.size()) + " " +
                  HtmlPage::escape(std::string(r.reason));
    }
    rows.push_back({std::string(stage.name), std::to_string(stage.poses.size()), rejected,
                    fixed(stage.milliseconds, 1)});
    if (!truths_.empty()) rows.back().push_back(std::to_string(count_right(stage)));
  }
  page.table(head, rows);
}

Status ModelExplanation::write_stage(std::size_t index, HtmlPage& page) const {
  const TraceStage& stage = trace_.stages[index];
  std::size_t all = stage.poses.size();
  for (const Rejected& rejected : stage.rejected) all += rejected.poses.size();
  std::vector<DrawnPoses> groups;
  std::vector<LegendEntry> legend = {{kAlive, std::to_string(stage.poses.size()) + " alive"}};
  for (std::size_t i = 0; i < stage.rejected.size(); ++i) {
    const Rejected& rejected = stage.rejected[i];
    const Rgb color = kRejected[std::min(i, std::size(kRejected) - 1)];
    groups.push_back({rejected.poses, color,
                      all <= kMaxOutlined ? DrawnPoses::Style::outlines : DrawnPoses::Style::dots});
    legend.push_back(
        {color, std::to_string(rejected.poses.size()) + " " + std::string(rejected.reason)});
  }
  const bool outlined = stage.poses.size() <= kMaxOutlinedAlive;
  groups.push_back(
      {stage.poses, kAlive, outlined ? DrawnPoses::Style::outlines : DrawnPoses::Style::dots});
  std::vector<FastPose> truths;
  for (const Pose& truth : truths_) truths.push_back(to_fast(truth));
  if (!truths.empty()) {
    groups.push_back({truths, kTrue, DrawnPoses::Style::dashed});
    legend.push_back({kTrue, "truth; right and alive: " + std::to_string(count_right(stage))});
  }
  const std::string file = numbered(static_cast<int>(index) + 3, stage.name);
  page.heading(std::string(stage.title));
  page.picture(file, std::string(stage.text) + std::string(outlined ? kOutlines : kDots));
  const std::string title =
      model_.name + ": " + std::string(stage.name) + ", " + fixed(stage.milliseconds, 1) + " ms";
  return io::write_color_png(
      folder_ + "/" + file,
      draw::with_words(draw::poses(frame_.frame, model_, groups), title, legend));
}

Status ModelExplanation::write_best(HtmlPage& page) const {
  const int number = static_cast<int>(trace_.stages.size()) + 3;
  const std::string sheet = numbered(number, "best"),
                    segments = numbered(number + 1, "best_segments");
  page.heading("The best placement");
  page.picture(sheet,
               "The placement in green and the truth, where it is known, in dashed white: in the "
               "frame (left) and its surroundings (right).");
  const std::string title =
      model_.name + ": best placement, probability " + fixed(best_->probability, 3);
  Status status = io::write_color_png(
      folder_ + "/" + sheet,
      draw::with_words(draw::pose_from_near(frame_.frame, model_, best_->pose(), truths_), title));
  if (!status.ok()) return status;
  write_layer(page);
  const SceneFeatures& scene = frame_.trace.scene;
  const auto matches = match_segments(scene.segmentation, scene.map, model_, best_->pose(),
                                      predict_surface(scene.image, model_, best_->pose()));
  page.heading("Its super-pixels");
  page.picture(segments,
               "Those that the placement touches, from green (belongs to the model) to red (does "
               "not): what the components segment and segment_affinity are made of.");
  return io::write_color_png(folder_ + "/" + segments,
                             draw::segment_matches(frame_.frame, scene.segmentation, matches));
}

void ModelExplanation::write_layer(HtmlPage& page) const {
  const ScoreLayer& layer = frame_.layers.last_for(best_->values);
  std::vector<Row> rows;
  for (std::size_t i = 0; i < kScoreComponents.size(); ++i) {
    const ComponentType& type = kScoreComponents[i];
    const ScoreLayer::Component& c = layer.components[i];
    const double value = best_->values[i], part = c.at(value);
    rows.push_back(
        {std::string(type.name), fixed(value, 4), std::string(type.unit),
         type.learned ? fixed(c.place.front(), 3) + " to " + fixed(c.place.back(), 3) : "",
         type.learned ? fixed(part, 3) : "", type.learned ? HtmlPage::bar(part) : "",
         std::string(type.meaning)});
  }
  rows.push_back({"bias", "", "", "", fixed(layer.bias, 3), HtmlPage::bar(layer.bias), ""});
  if (best_->prior != 0) {
    rows.push_back({"prior", fixed(best_->prior, 3), "log odds", "", fixed(best_->prior, 3),
                    HtmlPage::bar(best_->prior), "What the caller's priors add."});
  }
  rows.push_back({"sum", "", "", "", fixed(best_->score, 3), HtmlPage::bar(best_->score), ""});
  page.table({"score component", "value", "unit", "usual in training", "adds to the log odds", "",
              "meaning"},
             rows);
  page.paragraph("The score layer: " + layer.provenance + ".");
}

}  // namespace bpa::cli
