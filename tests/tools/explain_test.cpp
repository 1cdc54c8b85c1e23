// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What bpa detect --explain writes, against the trace that it is written from.
#include <filesystem>

#include <gtest/gtest.h>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/io/image_file.hpp"
#include "core/pipeline/detector.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/explain_folder.hpp"

namespace bpa {
namespace {

using cli::ExplainedFrame;
using cli::ExplainFolder;

constexpr const char* kModelPictures[] = {
    "03_sample.png",  "04_check.png",  "05_correct.png", "06_cluster.png",      "07_round_two.png",
    "08_refine.png",  "09_score.png",  "10_climb.png",   "11_turn.png",         "12_lay.png",
    "13_compare.png", "14_select.png", "15_best.png",    "16_best_segments.png"};

/// An L on a table, and a brick that is not there.
class Explain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    l_ = test::l_model();
    brick_ = test::brick_model();
    const Pose camera_from_world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
    truth_ = {{1, camera_from_world * test::standing_at(-0.08, 0, 0.02, 0.7), 1.0}};
    const auto solids = test::together({test::table(camera_from_world)},
                                       test::l_solids(truth_[0].camera_from_object));
    frame_ = test::render(solids, test::kinect_camera(), 1, 8).frame;
  }
  static void TearDownTestSuite() {
    l_.reset();
    brick_.reset();
  }

  void search(const std::vector<std::shared_ptr<const ObjectModel>>& models, double budget_ms = 0) {
    const auto library = std::make_shared<ModelLibrary>();
    for (const auto& model : models) ASSERT_TRUE(library->add(model).ok());
    DetectRequest request;
    request.budget_ms = budget_ms;
    trace_ = {};
    auto result = Detector(library, {}).detect(frame_, request, &trace_);
    ASSERT_TRUE(result.ok()) << result.status().message;
    result_ = std::move(*result);
  }
  ExplainedFrame explained(const std::string& name = "000001_000002") const {
    return {
        "scene 1 image 2", name, frame_, trace_, result_, score::default_score_layers(), truth_};
  }
  void expect_picture(const std::string& path) const {
    const auto image = io::read_color_image(folder_ / path);
    ASSERT_TRUE(image.ok()) << image.status().message;
    EXPECT_GE(image->width, frame_.camera.width);
  }
  std::string page(const std::string& path) const { return test::slurp(folder_ / path); }

  static inline std::shared_ptr<const ObjectModel> l_, brick_;
  static inline std::vector<io::BopInstance> truth_;
  static inline Frame frame_;
  FrameTrace trace_;
  SceneInterpretations result_;
  const test::TemporaryFolder folder_;
};

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }

TEST_F(Explain, OneModelIsOneFolderWhosePageAgreesWithTheTrace) {
  search({l_});
  ExplainFolder folder(folder_ / "out", false);
  folder.add(explained());
  folder.finish();
  expect_picture("out/01_edges.png");
  expect_picture("out/02_super_pixels.png");
  const std::string text = page("out/index.html");
  for (const char* picture : kModelPictures) {
    expect_picture(std::string("out/") + picture);
    EXPECT_NE(text.find(std::string("src=\"") + picture), std::string::npos) << picture;
  }
  for (const detect::TraceStage& stage : trace_.objects.at(0).stages) {
    EXPECT_NE(text.find(cell(std::string(stage.name)) + cell(std::to_string(stage.poses.size()))),
              std::string::npos)
        << stage.name;
    for (const detect::Rejected& rejected : stage.rejected) {
      EXPECT_NE(
          text.find(std::to_string(rejected.poses.size()) + " " + std::string(rejected.reason)),
          std::string::npos)
          << stage.name << ": " << rejected.reason;
    }
  }
  EXPECT_NE(text.find("It is truly there 1 time"), std::string::npos);
  EXPECT_NE(text.find("holds it."), std::string::npos);
  // Every number that the score layer adds up is there, and they add up.
  ASSERT_FALSE(trace_.candidates.empty());
  const detect::Candidate& best = trace_.candidates.front();
  const score::ScoreLayer& layer = score::default_score_layers().last_for(best.values);
  double sum = layer.bias;
  const std::size_t table = text.find("adds to the log odds</th>");
  ASSERT_NE(table, std::string::npos);
  for (std::size_t i = 0; i < score::kScoreComponents.size(); ++i) {
    const std::string name(score::kScoreComponents[i].name);
    const double part = layer.components[i].at(best.values[i]);
    sum += part;
    const std::size_t row = text.find("<tr>" + cell(name), table);
    ASSERT_NE(row, std::string::npos) << name;
    const std::string line = text.substr(row, text.find("</tr>", row) - row);
    EXPECT_NE(line.find(cell(fixed(best.values[i], 4))), std::string::npos) << line;
    if (!score::kScoreComponents[i].learned) continue;
    EXPECT_NE(line.find(cell(fixed(part, 3))), std::string::npos) << line;
  }
  EXPECT_NEAR(sum, best.score, 1e-9);
  const std::string sum_row = "<tr>" + cell("sum") + cell("") + cell("") + cell("");
  EXPECT_NE(text.find(sum_row + cell(fixed(best.score, 3))), std::string::npos);
}

TEST_F(Explain, SeveralModelsHaveAFolderEach) {
  search({l_, brick_});
  ExplainFolder folder(folder_ / "out", false);
  folder.add(explained());
  folder.finish();
  expect_picture("out/01_edges.png");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/03_sample.png"));
  const std::string text = page("out/index.html");
  for (const char* name : {"l", "brick"}) {
    expect_picture(std::string("out/") + name + "/14_select.png");
    EXPECT_NE(text.find("href=\"" + std::string(name) + "/index.html\""), std::string::npos);
    EXPECT_FALSE(page(std::string("out/") + name + "/index.html").empty());
  }
  EXPECT_NE(page("out/brick/index.html").find("The model is not truly there."), std::string::npos);
}

TEST_F(Explain, SeveralFramesHaveAFolderEach) {
  search({l_});
  ExplainFolder folder(folder_ / "out", true);
  folder.add(explained("000001_000002"));
  folder.add(explained("000001_000003"));
  folder.finish();
  const std::string text = page("out/index.html");
  for (const std::string name : {"000001_000002", "000001_000003"}) {
    expect_picture("out/" + name + "/03_sample.png");
    EXPECT_NE(text.find("href=\"" + name + "/index.html\""), std::string::npos);
  }
}

TEST_F(Explain, AModelThatTimeWasTooShortForIsSaid) {
  search({l_, brick_}, 1e-6);
  ASSERT_TRUE(result_.budget_exhausted);
  ExplainFolder folder(folder_ / "out", false);
  folder.add(explained());
  EXPECT_NE(page("out/brick/index.html").find("time budget was exhausted"), std::string::npos);
}

TEST_F(Explain, AFolderThatCannotBeMadeIsNamed) {
  search({l_});
  test::spill(folder_ / "file", "");
  ExplainFolder folder(folder_ / "file/out", false);
  try {
    folder.add(explained());
    FAIL() << "the folder was made";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status().code, StatusCode::unavailable);
    EXPECT_NE(failure.status().message.find("file/out"), std::string::npos) << failure.what();
  }
}

}  // namespace
}  // namespace bpa
