// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/plot.hpp"

#include <gtest/gtest.h>

#include "core/draw/html_page.hpp"
#include "core/draw/report_plots.hpp"
#include "core/io/image_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::draw {
namespace {

/// Pixels of the first series' blue in a row of the picture.
int blue_in_row(const io::ColorImage& picture, int v) {
  int count = 0;
  for (int u = 0; u < picture.width; ++u) {
    const std::uint8_t* p = picture.pixels.data() + 3 * (v * picture.width + u);
    count += p[2] > 150 && p[0] < 80;
  }
  return count;
}

TEST(BarPlot, BarsAreAsLongAsTheirValues) {
  const io::ColorImage picture =
      bar_plot("title", {"all", "half", "none"}, {1.0, 0.5, 0.0}, {"", "", ""});
  const auto bar = [&](int row) { return blue_in_row(picture, 44 + 24 * row + 9); };
  EXPECT_GT(bar(0), 300);
  EXPECT_NEAR(bar(1), bar(0) / 2.0, 2);
  EXPECT_EQ(bar(2), 0);
}

TEST(LinePlot, ALevelLineIsAtItsValue) {
  const io::ColorImage picture = line_plot({"t", "x", "y"}, {{"s", {0.1, 0.9}, {0.25, 0.25}}});
  int row = 0;
  for (int v = 100; v < picture.height; ++v) {
    if (blue_in_row(picture, v) > blue_in_row(picture, row)) row = v;
  }
  EXPECT_NEAR(row, 50 + 0.75 * 360, 2);  // the area is 360 rows from row 50
  EXPECT_NEAR(blue_in_row(picture, row), 0.8 * 540, 15);
}

TEST(WritePlots, FalsePositivesAreAtTheirNumber) {
  const test::TemporaryFolder folder;
  eval::EvaluationReport report;
  report.threshold_curve = {{0, {0, 4}, {}, 2}, {1, {0, 4}, {}, 2}};
  ASSERT_TRUE(write_plots(folder.path(), report).ok());
  const auto picture = io::read_color_image(folder / "false_positives.png");
  ASSERT_TRUE(picture.ok());
  EXPECT_GT(blue_in_row(*picture, 50), 500) << "the axis ends at 2, at the top of the area";
}

TEST(WritePlots, AllOfThemAlsoOfNothing) {
  const test::TemporaryFolder folder;
  eval::EvaluationReport report;
  report.recall_at[1] = {1, 2};
  report.by_object = {{"mug", {1, 2}, {1, 1}}};
  report.outcomes.resize(2);
  report.threshold_curve = {{0.1, {1, 3}, {1, 2}, 2}, {0.5, {1, 1}, {1, 2}, 0}};
  for (const eval::EvaluationReport& some : {report, eval::EvaluationReport{}}) {
    ASSERT_TRUE(write_plots(folder.path(), some).ok());
    for (const char* name :
         {"recall", "precision_recall", "false_positives", "reliability", "coverage", "reports",
          "visible_fraction", "visible_histogram", "distance", "objects", "time"}) {
      EXPECT_TRUE(io::read_color_image(folder / (std::string(name) + ".png")).ok()) << name;
    }
  }
}

TEST(HtmlPage, EscapesTextAndSizesBars) {
  HtmlPage page("a < b & \"c\"");
  EXPECT_NE(page.finish().find("<h1>a &lt; b &amp; &quot;c&quot;</h1>"), std::string::npos);
  EXPECT_NE(HtmlPage::bar(2).find("width:24px;margin-left:120px"), std::string::npos);
  EXPECT_NE(HtmlPage::bar(-20).find("width:120px;margin-left:0px"), std::string::npos);
}

}  // namespace
}  // namespace bpa::draw
