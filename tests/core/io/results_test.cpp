// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/results.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

Placement some_placement(int obj_id, double probability) {
  Placement placement;
  placement.model_number = obj_id;
  placement.model = "cup";
  placement.frame_from_object = {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.3).normalized(),
                                 {0.1, -0.2, 0.9}};
  placement.covariance.setRandom();
  placement.orientation.axes.setRandom();
  placement.orientation.concentrations.setRandom();
  placement.score = -1.25;
  placement.probability = probability;
  placement.presence = 0.5 * (1 + probability);
  placement.visible_fraction = 0.3;
  placement.components = {{"range", 1.0 / 3}};
  placement.alternatives = {{placement.frame_from_object, 0.25}};
  return placement;
}

std::vector<FrameResult> some_results() {
  FrameResult frame;
  frame.scene_id = 2;
  frame.im_id = 5;
  frame.seconds = 0.1;
  frame.fused_frames = 5;
  frame.sensor = "active_stereo";
  frame.timings = {{"edges", 12.5}};
  frame.effort = {.rounds = 4, .full_scores = 87};
  frame.interpretations.resize(2);
  frame.interpretations[0].placements = {some_placement(3, 0.9), some_placement(4, 0.1)};
  frame.interpretations[1].rank = 2;
  frame.interpretations[1].placements = {some_placement(3, 0.8)};
  FrameResult empty;
  empty.scene_id = 2;
  empty.im_id = 6;
  empty.interpretations.resize(1);
  return {frame, empty};
}

TEST(Results, WholeNumbersAreWholeAndFit) {
  const test::TemporaryFolder folder;
  const auto with_id = [&](const std::string& id) {
    test::spill(folder / "r.json",
                R"({"format": "bpa results", "version": 1.0, "frames": [{"scene_id": )" + id +
                    R"(, "im_id": 1, "seconds": 0, "interpretations": []}]})");
    return read_results_json(folder / "r.json");
  };
  EXPECT_EQ(with_id("-7.0")->front().scene_id, -7);
  for (const char* id : {"1e300", "-1e300", "2147483648", "18446744073709551615", "1.5", "null"}) {
    EXPECT_EQ(with_id(id).status().code, StatusCode::corrupt) << id;
  }
  test::spill(folder / "r.csv", "1e300,5,3,0.9,1 0 0 0 1 0 0 0 1,10 20 900,0.1\n");
  EXPECT_EQ(read_results_csv(folder / "r.csv").status().code, StatusCode::corrupt);
}

TEST(Results, DeepJsonIsRefused) {
  const test::TemporaryFolder folder;
  const std::size_t levels = 1'000'000;
  test::spill(folder / "r.json", std::string(levels, '[') + std::string(levels, ']'));
  const Status status = read_results_json(folder / "r.json").status();
  EXPECT_EQ(status.code, StatusCode::corrupt);
  EXPECT_NE(status.message.find("64 levels"), std::string::npos) << status.message;
}

TEST(Results, JsonKeepsEverythingToTheLastBit) {
  const test::TemporaryFolder folder;
  const std::vector<FrameResult> results = some_results();
  ASSERT_TRUE(write_results_json(folder / "r.json", results).ok());
  const auto back = read_results_json(folder / "r.json");
  ASSERT_TRUE(back.ok()) << back.status().message;
  ASSERT_EQ(back->size(), 2u);
  EXPECT_EQ(back->at(1).interpretations.size(), 1u);
  const FrameResult& frame = back->at(0);
  EXPECT_EQ(frame.seconds, 0.1);
  EXPECT_EQ(frame.fused_frames, 5);
  EXPECT_EQ(frame.sensor, "active_stereo");
  EXPECT_EQ(frame.effort, (SearchEffort{.rounds = 4, .full_scores = 87}));
  ASSERT_EQ(frame.interpretations.size(), 2u);
  const Placement& a = results[0].interpretations[0].placements[1];
  const Placement& b = frame.interpretations[0].placements.at(1);
  EXPECT_EQ(b.model_number, 4);
  EXPECT_EQ(b.model, "cup");
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.orientation.axes, b.orientation.axes);
  EXPECT_EQ(a.orientation.concentrations, b.orientation.concentrations);
  EXPECT_EQ(a.frame_from_object.rotation.coeffs(), b.frame_from_object.rotation.coeffs());
  EXPECT_EQ(a.frame_from_object.translation, b.frame_from_object.translation);
  EXPECT_EQ(b.components.at(0).value, 1.0 / 3);
  EXPECT_EQ(b.alternatives.at(0).weight, 0.25);
}

TEST(Results, CsvHoldsTheBestInterpretation) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_results_csv(folder / "r.csv", some_results()).ok());
  const auto back = read_results_csv(folder / "r.csv");
  ASSERT_TRUE(back.ok()) << back.status().message;
  ASSERT_EQ(back->size(), 1u);
  EXPECT_EQ(back->front().scene_id, 2);
  EXPECT_EQ(back->front().im_id, 5);
  EXPECT_EQ(back->front().seconds, 0.1);
  ASSERT_EQ(back->front().interpretations.at(0).placements.size(), 2u);
  const Placement& placement = back->front().interpretations[0].placements[0];
  EXPECT_EQ(placement.model_number, 3);
  EXPECT_EQ(placement.presence, 0.95);
  EXPECT_EQ(placement.probability, 0.95);
  const Pose pose = some_placement(3, 1).frame_from_object;
  EXPECT_LT(rotation_angle(placement.frame_from_object.rotation, pose.rotation), 1e-7);
  EXPECT_LT((placement.frame_from_object.translation - pose.translation).norm(), 1e-12);
}

TEST(Results, TheBenchmarksOwnCsvFormIsRead) {
  const test::TemporaryFolder folder;
  test::spill(folder / "r.csv",
              "scene_id,im_id,obj_id,score,R,t,time\r\n"
              "1,3,8,0.5,0 -1 0 1 0 0 0 0 1,10 20.5 -30,-1\r\n");
  const auto back = read_results_csv(folder / "r.csv");
  ASSERT_TRUE(back.ok()) << back.status().message;
  const Pose& pose = back->at(0).interpretations.at(0).placements.at(0).frame_from_object;
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.01, 1.0205, -0.03)).norm(), 1e-12);
}

TEST(Results, BadFilesNameLineAndColumn) {
  const test::TemporaryFolder folder;
  test::spill(folder / "r.csv", "1,3,8,0.5,0 -1 0 1 0 0 0 0 1,10 20.5,-1\n");
  Status status = read_results_csv(folder / "r.csv").status();
  EXPECT_EQ(status.code, StatusCode::corrupt);
  EXPECT_NE(status.message.find("line 1: wrong column t"), std::string::npos) << status.message;
  test::spill(folder / "r.csv", "1,3,8,0.5\n");
  EXPECT_EQ(read_results_csv(folder / "r.csv").status().code, StatusCode::corrupt);
  test::spill(folder / "r.json", "{\"format\": \"bpa results\", \"version\": 1}");
  EXPECT_EQ(read_results_json(folder / "r.json").status().code, StatusCode::corrupt);
}

}  // namespace
}  // namespace bpa::io
