// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/explain_folder.hpp"

#include "core/draw/number.hpp"
#include "core/draw/scene_features.hpp"
#include "core/draw/sheet.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"

namespace bpa::cli {
namespace {

using draw::fixed;
using draw::HtmlPage;
using Row = std::vector<std::string>;

Status write_frame_pictures(const ExplainedFrame& frame, const std::string& folder,
                            HtmlPage& page) {
  const SceneFeatures& scene = frame.trace.scene;
  page.heading("Edges");
  page.picture(
      "01_edges.png",
      "Left: edges in red where a surface hides another, blue on the surface behind, green "
      "along creases, yellow in the colours. Right: the edge image, bright where an object "
      "is likely to end.");
  Status status = io::write_color_png(
      folder + "/01_edges.png",
      draw::with_words(draw::beside(draw::edges(frame.frame, scene.edges),
                                    draw::edge_image(frame.frame, scene.edges.likelihood)),
                       "edges and edge image",
                       {{{255, 50, 50}, "occluding"},
                        {{60, 110, 255}, "occluded"},
                        {{40, 220, 70}, "curvature"},
                        {{250, 220, 40}, "image"}}));
  if (!status.ok()) return status;
  page.heading("Super-pixels");
  page.picture("02_super_pixels.png",
               "Left: borders in white where the two sides hardly belong together, black where the "
               "surface goes on. Right: each in its mean colour.");
  return io::write_color_png(
      folder + "/02_super_pixels.png",
      draw::with_words(draw::beside(draw::segment_borders(frame.frame, scene.segmentation),
                                    draw::segment_means(frame.frame, scene.segmentation)),
                       std::to_string(scene.segmentation.segments.size()) + " super-pixels"));
}

void write_timings(const SceneInterpretations& result, HtmlPage& page) {
  std::vector<Row> rows;
  for (const StageTiming& timing : result.timings) {
    rows.push_back({HtmlPage::escape(timing.stage), fixed(timing.milliseconds, 1)});
  }
  rows.push_back({"all", fixed(result.total_milliseconds, 1)});
  page.table({"stage of the frame", "milliseconds"}, rows);
}

Status write_models(const ExplainedFrame& frame, const std::string& folder, HtmlPage& page) {
  std::vector<Row> rows;
  for (std::size_t m = 0; m < frame.trace.models.size(); ++m) {
    const std::string& name = frame.trace.models[m]->name;
    ModelExplanation writer(frame, m, folder + "/" + name);
    HtmlPage model_page(name + " in " + frame.title);
    if (Status status = writer.write(model_page); !status.ok()) return status;
    Status status = io::write_file(folder + "/" + name + "/index.html", model_page.finish());
    if (!status.ok()) return status;
    rows.push_back(writer.summary());
  }
  Row head = stage_names();
  head.insert(head.begin(), "model");
  head.insert(head.end(), {"probability of the best", "in the best interpretation"});
  page.heading("Models and hypotheses alive after each stage");
  page.table(head, rows);
  return {};
}

}  // namespace

Status ExplainFolder::add(const ExplainedFrame& frame) {
  const std::string folder = several_frames_ ? folder_ + "/" + frame.name : folder_;
  const bool one_model = frame.trace.models.size() == 1;
  HtmlPage page(one_model ? frame.trace.models[0]->name + " in " + frame.title : frame.title);
  write_timings(frame.result, page);
  if (Status status = write_frame_pictures(frame, folder, page); !status.ok()) return status;
  Status status;
  if (one_model) {
    status = ModelExplanation(frame, 0, folder).write(page);
  } else {
    status = write_models(frame, folder, page);
  }
  if (!status.ok()) return status;
  std::string found;
  if (!frame.result.interpretations.empty()) {
    for (const Placement& p : frame.result.interpretations.front().placements) {
      found += (found.empty() ? "" : ", ") + p.model + " " + fixed(p.probability, 2);
    }
  }
  frames_.push_back({HtmlPage::link(frame.name + "/index.html", frame.title),
                     HtmlPage::escape(found), fixed(frame.result.total_milliseconds, 0)});
  return io::write_file(folder + "/index.html", page.finish());
}

Status ExplainFolder::finish() const {
  if (!several_frames_) return {};
  HtmlPage page("Searched frames");
  page.table({"frame", "the best interpretation", "milliseconds"}, frames_);
  return io::write_file(folder_ + "/index.html", page.finish());
}

}  // namespace bpa::cli
