// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/convert/results.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/cli/convert.hpp"
#include "client/src/convert.hpp"
#include "idl/wire/cdr.hpp"

// One result as the core has it, as bytes on the wire, in the SDK's structs and in a file.

namespace bpa::cli {
namespace {

namespace msgs = wire::bpa_msgs;
using Json = nlohmann::json;

/// A placement in which every number differs from every other.
Placement placement() {
  Placement p;
  p.model = "mug";
  p.model_number = 3;
  p.frame_from_object = {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.3).normalized(), {0.1, -0.2, 0.9}};
  for (int i = 0; i < 36; ++i) p.covariance(i / 6, i % 6) = 100 + i;
  for (int i = 0; i < 12; ++i) p.orientation.axes(i / 3, i % 3) = 200 + i;
  p.orientation.concentrations = {-31, -21, -11};
  p.score = -1.25;
  p.probability = 0.9;
  p.presence = 0.95;
  p.visible_fraction = 0.3;
  p.components = {{"color", 0.125}, {"range", 1.0 / 3}};
  p.alternatives = {{{Eigen::Quaterniond(0.1, 0.2, 0.3, 0.4).normalized(), {1, 2, 3}}, 0.25}};
  return p;
}

io::FrameResult result() {
  io::FrameResult frame;
  frame.scene_id = 48;
  frame.im_id = 7;
  frame.stamp_ns = 3'000'000'007;
  frame.frame_id = "48/7";
  frame.timings = {{"cloud", 12.5}, {"edges", 3.25}};
  frame.total_milliseconds = 20;
  frame.seconds = 0.02;
  frame.budget_exhausted = true;
  frame.fused_frames = 4;
  frame.missed = {{"mug", 0.25}, {"can", 0}};
  frame.interpretations = {{1, 5.5, 0.75, {placement(), placement()}}, {2, 4.5, 0.25, {}}};
  frame.server.emplace();
  return frame;
}

/// What the SDK makes of the message that the server makes of a result.
DetectionSet received(const Result<SceneInterpretations>& found, const io::FrameResult& frame) {
  const auto sent = server::interpretations_message(found, {frame.stamp_ns, frame.frame_id, 18, 7});
  std::vector<std::uint8_t> bytes(wire::encoded_size(sent));
  wire::encode(sent, bytes.data(), bytes.size());
  msgs::SceneInterpretations message;
  EXPECT_TRUE(wire::decode(bytes.data(), bytes.size(), message).ok());
  return sdk::to_detections(message);
}

TEST(ClientResults, AreInFilesAsTheDetectorMadeThem) {
  const io::FrameResult made = result();
  const DetectionSet set = received(SceneInterpretations(made), made);
  EXPECT_EQ(set.models_searched, 18);
  EXPECT_EQ(set.seed, 7U);
  ASSERT_EQ(set.interpretations.size(), 2U);
  EXPECT_EQ(set.best().at(1).instance, 1);
  EXPECT_EQ(io::result_json_line(to_frame_result(set)), io::result_json_line(made));
}

TEST(ClientResults, HaveTheirKeys) {
  const io::FrameResult made = result();
  const Placement& expected = made.interpretations[0].placements[0];
  const auto line =
      io::result_json_line(to_frame_result(received(SceneInterpretations(made), made)));
  const Json json = Json::parse(line);
  EXPECT_EQ(json.at("scene_id"), 48);
  EXPECT_EQ(json.at("im_id"), 7);
  EXPECT_EQ(json.at("frame_id"), "48/7");
  EXPECT_EQ(json.at("stamp_ns"), made.stamp_ns);
  EXPECT_EQ(json.at("seconds"), 0.02);
  EXPECT_EQ(json.at("status"), "ok");
  EXPECT_EQ(json.at("message"), "");
  EXPECT_EQ(json.at("queue_position"), 0);
  EXPECT_EQ(json.at("budget_exhausted"), true);
  EXPECT_EQ(json.at("fused_frames"), 4);
  EXPECT_EQ(json.at("missed").at(0).at("model"), "mug");
  EXPECT_EQ(json.at("missed").at(0).at("expected"), 0.25);
  EXPECT_EQ(json.at("timings"), Json::parse(R"([{"stage": "cloud", "milliseconds": 12.5},
                                                {"stage": "edges", "milliseconds": 3.25}])"));
  EXPECT_EQ(json.at("interpretations").at(1),
            Json::parse(R"({"rank": 2, "score": 4.5, "probability": 0.25, "placements": []})"));
  const Json& p = json.at("interpretations").at(0).at("placements").at(0);
  EXPECT_EQ(p.size(), 11U);
  EXPECT_EQ(p.at("obj_id"), 3);
  EXPECT_EQ(p.at("model"), "mug");
  EXPECT_EQ(p.at("pose").at("translation_m"), (std::vector<double>{0.1, -0.2, 0.9}));
  const Eigen::Quaterniond& q = expected.frame_from_object.rotation;
  EXPECT_EQ(p.at("pose").at("rotation_wxyz"), (std::vector<double>{q.w(), q.x(), q.y(), q.z()}));
  for (std::size_t i = 0; i < 36; ++i) EXPECT_EQ(p.at("covariance").at(i), 100 + i);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(p.at("bingham").at("axes").at(i), 200 + i);
  EXPECT_EQ(p.at("bingham").at("concentrations"), (std::vector<double>{-31, -21, -11}));
  EXPECT_EQ(p.at("score"), -1.25);
  EXPECT_EQ(p.at("probability"), 0.9);
  EXPECT_EQ(p.at("presence"), 0.95);
  EXPECT_EQ(p.at("visible_fraction"), 0.3);
  EXPECT_EQ(p.at("components"),
            (std::map<std::string, double>{{"color", 0.125}, {"range", 1.0 / 3}}));
  EXPECT_EQ(p.at("alternatives").at(0).at("weight"), 0.25);
  EXPECT_EQ(p.at("alternatives").at(0).at("pose").at("translation_m"),
            (std::vector<double>{1, 2, 3}));
}

TEST(ClientResults, SayWhyAFrameWasNotSearched) {
  const io::FrameResult made = result();
  const DetectionSet set = received(Status(StatusCode::busy, "the queue is full"), made);
  const Json json = Json::parse(io::result_json_line(to_frame_result(set)));
  EXPECT_EQ(json.at("status"), "busy");
  EXPECT_EQ(json.at("message"), "the queue is full");
  EXPECT_TRUE(json.at("interpretations").empty());
}

double log_density(const OrientationSpread& spread, const Eigen::Vector4d& wxyz) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = Eigen::Vector4d::Map(spread.axes[k].data()).dot(wxyz);
    sum += spread.concentrations[k] * along * along;
  }
  return sum;
}

TEST(ClientPriors, AreWhatTheSdkMakesOfTheSamePose) {
  const Eigen::Quaterniond rotation(0.6, 0, 0.8, 0);
  PosePrior prior;
  prior.model = "mug";
  prior.weight = 0.5;
  prior.position = PositionPrior{{0.1, 0.2, 0.7}, 4e-4 * Eigen::Matrix3d::Identity()};
  prior.orientation = orientation_uncertainty(rotation, 0.01 * Eigen::Matrix3d::Identity());
  const ExpectedPose made = to_expected_pose(prior);
  const ExpectedPose expected =
      expected_pose("mug", {{{0.1, 0.2, 0.7}}, {{0, 0.8, 0, 0.6}}}, 0.02, 0.1, 0.5);
  EXPECT_EQ(made.model, expected.model);
  EXPECT_EQ(made.weight, expected.weight);
  EXPECT_EQ(made.camera_from_object.position, expected.camera_from_object.position);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(made.position_covariance[i], expected.position_covariance[i], 1e-15);
  }
  const auto& q = made.camera_from_object.orientation;
  EXPECT_NEAR(std::abs(Eigen::Quaterniond(q[3], q[0], q[1], q[2]).dot(rotation)), 1, 1e-12);
  for (const Eigen::Vector4d& at :
       {Eigen::Vector4d(1, 0, 0, 0), Eigen::Vector4d(0.1, 0.7, -0.5, 0.5),
        Eigen::Vector4d(0.6, 0.1, 0.79, 0)}) {
    EXPECT_NEAR(log_density(made.orientation_spread, at),
                log_density(expected.orientation_spread, at), 1e-9);
  }
}

TEST(ClientPriors, LeaveOpenWhatIsUnknown) {
  PosePrior prior;
  prior.model = "bowl";
  const ExpectedPose made = to_expected_pose(prior);
  EXPECT_EQ(made.position_covariance, (std::array<double, 9>{}));
  EXPECT_EQ(made.orientation_spread.concentrations, (std::array<double, 3>{}));
  EXPECT_EQ(made.weight, 0.95);
}

TEST(FrameId, IsSceneAndImageOrNeither) {
  EXPECT_EQ(scene_and_image("48/7"), std::pair(48, 7));
  EXPECT_EQ(scene_and_image("48/7x"), std::pair(0, 0));
  EXPECT_EQ(scene_and_image("camera"), std::pair(0, 0));
}

}  // namespace
}  // namespace bpa::cli
