// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <set>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "client/cli/convert.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/l_scene.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"

// What a request may narrow down does what it says, through the SDK and a real server.

namespace bpa {
namespace {

using std::chrono::milliseconds;

Pose pose_of(const Detection& detection) {
  const auto& p = detection.camera_from_object.position;
  const auto& q = detection.camera_from_object.orientation;
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]), {p[0], p[1], p[2]}};
}

ObjectPose object_pose(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{{t.x(), t.y(), t.z()}}, {{q.x(), q.y(), q.z(), q.w()}}};
}

/// Two bricks and an L on a table. The models of the bricks and the L are not told that half turns
/// leave a brick as it was: nothing in the image decides between its poses.
class Questions : public test::LScene {
 protected:
  static void SetUpTestSuite() {
    const std::string folder = support::scratch_folder() + "/library";
    int number = 0;
    for (const auto& [name, mesh] :
         {std::pair{"brick", test::box_mesh(test::kBrickHalf)}, std::pair{"l", test::l_mesh()}}) {
      const auto source = modeling::model_source_from_mesh(mesh, name, ++number);
      ASSERT_TRUE(source.ok()) << source.status().message;
      ASSERT_TRUE(io::save_model(folder, *source).ok());
    }
    frame_ = test::render(test::together(everything(), {test::brick_solid(behind_)}),
                          test::kinect_camera(), 0.5f, 3)
                 .frame;
    log_ = support::scratch_folder() + "/questions.log";
    server_ = std::make_unique<support::Process>(
        std::vector<std::string>{BPA_BINARY_DIR "/bin/bpa-server", "--localhost", "--library",
                                 folder, "--namespace", support::test_namespace(), "--domain",
                                 std::to_string(support::test_domain()), "--threads", "1", "--set",
                                 "detector.max_references=200", "--set", "detector.max_refined=10",
                                 "--set", "detector.annealing_steps=3000",
                                 // Four poses of a brick share its probability.
                                 "--set", "detector.min_probability=0.2"},
        log_);
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message << support::read_text(log_);
    client_ = std::make_unique<Client>(std::move(*client));
  }
  static void TearDownTestSuite() {
    client_.reset();
    server_.reset();
  }

  static DetectionSet ask(const DetectQuery& query, const Frame& frame = frame_) {
    const auto found = client_->detect_in(cli::view_of(frame), query, milliseconds(60000));
    EXPECT_TRUE(found.ok()) << found.status().message << support::read_text(log_);
    return found.ok() ? *found : DetectionSet{};
  }

  /// Of the object that stands at `truth`, whichever way it is turned: in the best interpretation,
  /// or in any.
  static bool holds(const std::vector<Detection>& detections, const std::string& model,
                    const Pose& truth) {
    for (const Detection& d : detections) {
      if (d.model == model && (pose_of(d).translation - truth.translation).norm() < 0.02)
        return true;
    }
    return false;
  }
  static bool holds_pose(const std::vector<Detection>& detections, const std::string& model,
                         const Pose& truth) {
    for (const Detection& d : detections) {
      const PoseError error = pose_error(pose_of(d), truth, SymmetryGroup{});
      if (d.model == model && error.position < 0.02 && error.angle < 0.2) return true;
    }
    return false;
  }
  /// The image of every reported object's middle.
  static std::vector<Eigen::Vector2d> middles(const DetectionSet& set) {
    std::vector<Eigen::Vector2d> out;
    for (const RankedInterpretation& interpretation : set.interpretations) {
      for (const Detection& d : interpretation.detections) {
        out.push_back(frame_.camera.project(pose_of(d).translation));
      }
    }
    return out;
  }

  static inline const Pose behind_ = camera_from_world_ * test::standing_at(-0.02, 0.2, 0.025, 0.9);
  static inline Frame frame_;
  static inline std::string log_;
  static inline std::unique_ptr<support::Process> server_;
  static inline std::unique_ptr<Client> client_;
};

TEST_F(Questions, UnrestrictedAreAnsweredWithAllThatIsThere) {
  const DetectionSet all = ask({});
  EXPECT_TRUE(holds(all.best(), "l", l_truth_));
  EXPECT_TRUE(holds(all.best(), "brick", brick_truth_));
  EXPECT_TRUE(holds(all.best(), "brick", behind_));
  EXPECT_EQ(all.models_searched, 2);
  EXPECT_FALSE(all.budget_exhausted);
}

/// Some surface of what is reported lies in the region, but not necessarily its middle.
constexpr double kReach = 40;  // pixels; of a brick of 12 cm

TEST_F(Questions, RegionsBoundWhatIsReported) {
  const Eigen::Vector2d middle = frame_.camera.project(brick_truth_.translation);
  Frame narrowed = frame_;
  narrowed.roi = {static_cast<int>(middle.x()) - 75, static_cast<int>(middle.y()) - 75, 150, 150};
  const DetectionSet set = ask({}, narrowed);
  EXPECT_TRUE(holds(set.best(), "brick", brick_truth_));
  ASSERT_FALSE(middles(set).empty());
  for (const Eigen::Vector2d& p : middles(set)) {
    EXPECT_LT((p - middle).cwiseAbs().maxCoeff(), 75 + kReach) << p.transpose();
  }
}

TEST_F(Questions, MasksBoundWhatIsReported) {
  Frame narrowed = frame_;  // all but a disc about the brick
  const Eigen::Vector2d middle = frame_.camera.project(brick_truth_.translation);
  narrowed.mask.assign(frame_.depth.size(), 1);
  for (std::size_t i = 0; i < narrowed.mask.size(); ++i) {
    const auto u = static_cast<double>(i % static_cast<std::size_t>(frame_.camera.width));
    const auto v = static_cast<double>(i / static_cast<std::size_t>(frame_.camera.width));
    if ((Eigen::Vector2d(u, v) - middle).norm() < 100) narrowed.mask[i] = 0;
  }
  const DetectionSet set = ask({}, narrowed);
  EXPECT_TRUE(holds(set.best(), "l", l_truth_));
  EXPECT_TRUE(holds(set.best(), "brick", behind_));
  for (const Eigen::Vector2d& p : middles(set)) {
    EXPECT_GT((p - middle).norm(), 100 - kReach) << p.transpose();
  }
}

TEST_F(Questions, OnlyTheModelsThatAreNamedAreReported) {
  DetectQuery query;
  query.models = {"l"};
  const DetectionSet set = ask(query);
  EXPECT_EQ(set.models_searched, 1);
  EXPECT_TRUE(holds(set.best(), "l", l_truth_));
  for (const RankedInterpretation& interpretation : set.interpretations) {
    for (const Detection& d : interpretation.detections) EXPECT_EQ(d.model, "l");
  }
}

TEST_F(Questions, ABudgetThatRunsOutIsToldAndEveryModelWasSearched) {
  DetectQuery query;
  query.budget_ms = 1e-3;
  const DetectionSet cut = ask(query);
  EXPECT_TRUE(cut.budget_exhausted);
  EXPECT_EQ(cut.models_searched, ask({}).models_searched);

  query.budget_ms = 600000;
  const DetectionSet all = ask(query);
  EXPECT_FALSE(all.budget_exhausted);
  EXPECT_TRUE(holds(all.best(), "brick", brick_truth_));
  EXPECT_TRUE(holds(all.best(), "l", l_truth_));
}

TEST_F(Questions, PriorsDecideBetweenPosesThatLookTheSame) {
  const Pose half_turn{Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()};
  const Pose other = brick_truth_ * half_turn;
  DetectQuery query;
  query.models = {"brick"};
  const auto expect = [&](const Pose& named, const Pose& excluded) {
    query.priors = {expected_pose("brick", object_pose(named), 0.02, 0.1)};
    const DetectionSet set = ask(query);
    EXPECT_TRUE(holds_pose(set.best(), "brick", named));
    EXPECT_FALSE(holds_pose(set.best(), "brick", excluded));
  };
  expect(brick_truth_, other);
  expect(other, brick_truth_);
}

}  // namespace
}  // namespace bpa
