// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/explain_folder.hpp"

#include <algorithm>
#include <string_view>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/detect/stages.hpp"
#include "core/draw/html_page.hpp"
#include "core/draw/poses.hpp"
#include "core/draw/scene_features.hpp"
#include "core/draw/sheet.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/score/predicted_surface.hpp"
#include "core/score/segment_scores.hpp"

namespace bpa::cli {
namespace {

using draw::DrawnPoses;
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

std::string numbered(std::size_t number, std::string_view name) {
  return format("%02zu_", number) + std::string(name) + ".png";
}

/// A page and its pictures in a folder.
class Page : public HtmlPage {
 public:
  Page(const std::string& folder, const std::string& title) : HtmlPage(title), folder_(folder) {}

  /// Writes the picture, under its title and over its legend, if any, and shows it with the text.
  void show(const std::string& file, std::string_view text, const io::ColorImage& image,
            const std::string& title = "", const std::vector<LegendEntry>& legend = {}) {
    or_throw(io::write_color_png(folder_ + "/" + file, draw::with_words(image, title, legend)));
    picture(file, text);
  }
  void write() const { or_throw(io::write_file(folder_ + "/index.html", finish())); }

 private:
  std::string folder_;
};

/// What became of one model in one frame, as sections of a page.
class ModelExplanation {
 public:
  /// `index` counts FrameTrace::models. Nothing is owned.
  ModelExplanation(const ExplainedFrame& frame, std::size_t index)
      : frame_(frame), model_(*frame.trace.models[index]), trace_(frame.trace.objects[index]) {
    for (const io::BopInstance& instance : frame.truth) {
      if (instance.obj_id == model_.number) truths_.push_back(instance.camera_from_object);
    }
    for (const detect::Candidate& candidate : frame.trace.candidates) {
      if (candidate.model != &model_) continue;
      if (!best_ || candidate.score > best_->score) best_ = &candidate;
    }
  }

  /// Pictures 03 and on, and what the page says of them.
  void write(Page& page) const {
    if (frame_.result.budget_exhausted) {
      page.paragraph("The time budget was exhausted: the search stopped with what it had.");
    }
    page.paragraph(verdict());
    write_table(page);
    for (std::size_t i = 0; i < trace_.stages.size(); ++i) write_stage(i, page);
    if (best_) write_best(page);
  }

  /// The model's row of a table: how many are alive after each of detection_stages(), the
  /// probability of the best and whether the best interpretation holds it.
  Row summary() const {
    Row row = {HtmlPage::link(model_.name + "/index.html", model_.name)};
    for (const auto& stage : trace_.stages) row.push_back(std::to_string(stage.poses.size()));
    row.resize(1 + detect::detection_stages().size());
    row.push_back(best_ ? fixed(best_->probability, 2) : "");
    row.push_back(is_reported() ? "yes" : "");
    return row;
  }

 private:
  bool is_reported() const {
    if (!best_ || frame_.result.interpretations.empty()) return false;
    const auto& placements = frame_.result.interpretations.front().placements;
    return std::ranges::any_of(placements, [&](const Placement& p) {
      return p.model == model_.name && p.frame_from_object.translation == best_->pose().translation;
    });
  }

  std::string verdict() const {
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

  std::size_t count_right(const detect::TraceStage& stage) const {
    return std::ranges::count_if(stage.poses, [&](const FastPose& pose) {
      return eval::is_right_about_any(to_pose(pose), model_, frame_.truth);
    });
  }

  void write_table(Page& page) const {
    Row head = {"stage", "alive", "rejected", "milliseconds"};
    if (!truths_.empty()) head.push_back("right ones alive");
    std::vector<Row> rows;
    for (const auto& stage : trace_.stages) {
      std::string rejected;
      for (const detect::Rejected& r : stage.rejected) {
        rejected += (rejected.empty() ? "" : "<br>") + std::to_string(r.poses.size()) + " " +
                    HtmlPage::escape(std::string(r.reason));
      }
      rows.push_back({std::string(stage.name), std::to_string(stage.poses.size()), rejected,
                      fixed(stage.milliseconds, 1)});
      if (!truths_.empty()) rows.back().push_back(std::to_string(count_right(stage)));
    }
    page.table(head, rows);
  }

  void write_stage(std::size_t index, Page& page) const {
    const detect::TraceStage& stage = trace_.stages[index];
    const auto style = [](bool outlined) {
      return outlined ? DrawnPoses::Style::outlines : DrawnPoses::Style::dots;
    };
    std::size_t all = stage.poses.size();
    for (const detect::Rejected& rejected : stage.rejected) all += rejected.poses.size();
    const bool outlined = stage.poses.size() <= kMaxOutlinedAlive;
    std::vector<DrawnPoses> groups;
    std::vector<LegendEntry> legend = {{kAlive, std::to_string(stage.poses.size()) + " alive"}};
    for (std::size_t i = 0; i < stage.rejected.size(); ++i) {
      const detect::Rejected& rejected = stage.rejected[i];
      const Rgb color = kRejected[std::min(i, std::size(kRejected) - 1)];
      groups.push_back({rejected.poses, color, style(all <= kMaxOutlined)});
      legend.push_back(
          {color, std::to_string(rejected.poses.size()) + " " + std::string(rejected.reason)});
    }
    groups.push_back({stage.poses, kAlive, style(outlined)});
    std::vector<FastPose> truths;
    for (const Pose& truth : truths_) truths.push_back(to_fast(truth));
    if (!truths.empty()) {
      groups.push_back({truths, kTrue, DrawnPoses::Style::dashed});
      legend.push_back({kTrue, "truth; right and alive: " + std::to_string(count_right(stage))});
    }
    page.heading(std::string(stage.name));
    page.show(
        numbered(index + 3, stage.name),
        std::string(stage.text) + std::string(outlined ? kOutlines : kDots),
        draw::poses(frame_.frame, model_, groups),
        model_.name + ": " + std::string(stage.name) + ", " + fixed(stage.milliseconds, 1) + " ms",
        legend);
  }

  void write_best(Page& page) const {
    const std::size_t number = trace_.stages.size() + 3;
    page.heading("The best placement");
    page.show(numbered(number, "best"),
              "The placement in green and the truth, where it is known, in dashed white: in the "
              "frame (left) and its surroundings (right).",
              draw::pose_from_near(frame_.frame, model_, best_->pose(), truths_),
              model_.name + ": best placement, probability " + fixed(best_->probability, 3));
    write_layer(page);
    const SceneFeatures& scene = frame_.trace.scene;
    const auto matches =
        score::match_segments(scene.segmentation, scene.map, model_, best_->pose(),
                              score::predict_surface(scene.image, model_, best_->pose()));
    page.heading("Its super-pixels");
    page.show(numbered(number + 1, "best_segments"),
              "Those that the placement touches, from green (belongs to the model) to red (does "
              "not): what the components segment and segment_affinity are made of.",
              draw::segment_matches(frame_.frame, scene.segmentation, matches));
  }

  void write_layer(Page& page) const {
    const score::ScoreLayer& layer = frame_.layers.last_for(best_->values);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
      const score::ComponentType& type = score::kScoreComponents[i];
      const score::ScoreLayer::Component& c = layer.components[i];
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

  const ExplainedFrame& frame_;
  const ObjectModel& model_;
  const detect::ObjectTrace& trace_;
  std::vector<Pose> truths_;
  const detect::Candidate* best_ = nullptr;  ///< Null: no placement was good enough.
};

void write_frame_pictures(const ExplainedFrame& frame, Page& page) {
  const SceneFeatures& scene = frame.trace.scene;
  page.heading("Edges");
  page.show("01_edges.png",
            "Left: edges in red where a surface hides another, blue on the surface behind, green "
            "along creases, yellow in the colours. Right: the edge image, bright where an object "
            "is likely to end.",
            draw::beside(draw::edges(frame.frame, scene.edges),
                         draw::edge_image(frame.frame, scene.edges.likelihood)),
            "edges and edge image",
            {{{255, 50, 50}, "occluding"},
             {{60, 110, 255}, "occluded"},
             {{40, 220, 70}, "curvature"},
             {{250, 220, 40}, "image"}});
  page.heading("Super-pixels");
  page.show("02_super_pixels.png",
            "Left: borders in white where the two sides hardly belong together, black where the "
            "surface goes on. Right: each in its mean colour.",
            draw::beside(draw::segment_borders(frame.frame, scene.segmentation),
                         draw::segment_means(frame.frame, scene.segmentation)),
            std::to_string(scene.segmentation.segments.size()) + " super-pixels");
}

void write_timings(const SceneInterpretations& result, Page& page) {
  std::vector<Row> rows;
  for (const StageTiming& timing : result.timings) {
    rows.push_back({HtmlPage::escape(timing.stage), fixed(timing.milliseconds, 1)});
  }
  rows.push_back({"all", fixed(result.total_milliseconds, 1)});
  page.table({"stage of the frame", "milliseconds"}, rows);
}

void write_plan(const SceneInterpretations& result, Page& page) {
  std::vector<Row> rows;
  for (const auto& [name, value, reason] : result.plan) {
    rows.push_back({HtmlPage::escape(name), HtmlPage::escape(value), HtmlPage::escape(reason)});
  }
  page.heading("What the search ran with");
  page.table({"entry", "value", "why"}, rows);
}

void write_models(const ExplainedFrame& frame, const std::string& folder, Page& page) {
  std::vector<Row> rows;
  for (std::size_t m = 0; m < frame.trace.models.size(); ++m) {
    const std::string& name = frame.trace.models[m]->name;
    const ModelExplanation explanation(frame, m);
    Page model_page(folder + "/" + name, name + " in " + frame.title);
    explanation.write(model_page);
    model_page.write();
    rows.push_back(explanation.summary());
  }
  Row head = {"model"};
  for (const detect::Stage& stage : detect::detection_stages()) head.emplace_back(stage.name);
  head.insert(head.end(), {"probability of the best", "in the best interpretation"});
  page.heading("Models and hypotheses alive after each stage");
  page.table(head, rows);
}

}  // namespace

void ExplainFolder::add(const ExplainedFrame& frame) {
  const std::string folder = several_frames_ ? folder_ + "/" + frame.name : folder_;
  const bool one_model = frame.trace.models.size() == 1;
  Page page(folder, one_model ? frame.trace.models[0]->name + " in " + frame.title : frame.title);
  write_timings(frame.result, page);
  write_frame_pictures(frame, page);
  if (one_model) {
    ModelExplanation(frame, 0).write(page);
  } else {
    write_models(frame, folder, page);
  }
  std::string found;
  if (!frame.result.interpretations.empty()) {
    for (const Placement& p : frame.result.interpretations.front().placements) {
      found += (found.empty() ? "" : ", ") + p.model + " " + fixed(p.probability, 2);
    }
  }
  write_plan(frame.result, page);
  frames_.push_back({HtmlPage::link(frame.name + "/index.html", frame.title),
                     HtmlPage::escape(found), fixed(frame.result.total_milliseconds, 0)});
  page.write();
}

void ExplainFolder::finish() const {
  if (!several_frames_) return;
  Page page(folder_, "Searched frames");
  page.table({"frame", "the best interpretation", "milliseconds"}, frames_);
  page.write();
}

}  // namespace bpa::cli
