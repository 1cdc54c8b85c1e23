// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A data set of two frames whose every figure is worked out by hand.
#include "core/eval/evaluation.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::eval {
namespace {

using std::numbers::pi;

Pose posed_at(double x, double z, double turn = 0) {
  return {rotation_from_vector({0, 0, turn}), {x, 0, z}};
}

/// A cube of 10 cm around the origin.
TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? 0.05f : -0.05f, i & 2 ? 0.05f : -0.05f,
                               i & 4 ? 0.05f : -0.05f);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Object 1 has no symmetry, object 2 a half turn about z.
EvalObjects objects() {
  EvalObjects result;
  const double diameter = 0.1 * std::sqrt(3.0);
  result[1] = {"plain", diameter, {}, cube()};
  result[2] = {"turned", diameter, {}, cube()};
  result[2].symmetry.discrete = {{rotation_from_vector({0, 0, pi}), Eigen::Vector3d::Zero()}};
  return result;
}

io::BopFrame frame(int im_id, std::vector<io::BopInstance> truth) {
  io::BopFrame result;
  result.scene_id = 1;
  result.im_id = im_id;
  result.camera = {64, 48, 60, 60, 31.5, 23.5};
  result.has_truth = true;
  result.truth = std::move(truth);
  return result;
}

Placement placement(int obj_id, const Pose& pose, double probability) {
  Placement result;
  result.model_number = obj_id;
  result.frame_from_object = pose;
  result.probability = probability;
  result.covariance = 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
  return result;
}

io::FrameResult result(int im_id, double seconds,
                       std::vector<std::vector<Placement>> interpretations) {
  io::FrameResult frame;
  frame.scene_id = 1;
  frame.im_id = im_id;
  frame.seconds = seconds;
  for (auto& placements : interpretations) {
    frame.interpretations.emplace_back();
    frame.interpretations.back().placements = std::move(placements);
  }
  return frame;
}

EvaluationOptions without_bop() {
  EvaluationOptions options;
  options.bop_errors = false;
  return options;
}

TEST(Matching, IsGreedyByScoreAndOneToOne) {
  // The second estimate scores higher, so it takes truth 0, which both want most.
  EXPECT_EQ(match_greedily({0.2, 0.9, 0.5}, {{0.1, 0.2}, {0.3, 0.4}, {kNoMatch, kNoMatch}}),
            (std::vector<int>{1, 0, -1}));
  EXPECT_EQ(match_greedily({0.9, 0.2}, {{0.1}, {0.0}}), (std::vector<int>{0, -1}));
  EXPECT_TRUE(match_greedily({}, {}).empty());
}

struct Case {
  std::vector<io::BopFrame> frames;
  std::vector<io::FrameResult> results;
};

/// Frame 0: two plain and one turned object and one that is too hidden to count; frame 1: one plain
/// one at 1.3 m.
Case two_frames() {
  Case c;
  c.frames = {frame(0, {{1, posed_at(0, 0.7), 1.0},
                        {1, posed_at(0.3, 0.7), 0.35},
                        {2, posed_at(-0.3, 0.7), 0.95},
                        {1, posed_at(0.6, 0.7), 0.05}}),
              frame(1, {{1, posed_at(0, 1.3), 0.5}})};
  c.results = {
      result(0, 0.4,
             {{placement(1, posed_at(0.02, 0.7), 0.9),       // right: 20 mm off
               placement(1, posed_at(0.012, 0.7), 0.6),      // the same instance again: false
               placement(2, posed_at(-0.3, 0.7, pi), 0.95),  // right by symmetry
               placement(1, posed_at(0.6, 0.7), 0.8)},  // of the one that does not count: ignored
              {placement(1, posed_at(0.3, 0.7), 0.7)},  // the second finds what the first missed
              {}}),
      result(1, 0.8, {{placement(1, posed_at(0.03, 1.3), 0.55)}})};  // 30 mm off: false
  return c;
}

TEST(Evaluation, PaperProtocolByHand) {
  const Case c = two_frames();
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok()) << report.status().message;
  EXPECT_EQ(report->frames, 2);
  EXPECT_EQ(report->precision.hits, 2);
  EXPECT_EQ(report->precision.total, 4);
  EXPECT_EQ(report->recall.hits, 2);
  EXPECT_EQ(report->recall.total, 4);
  EXPECT_EQ(report->recall_at.at(1).hits, 2);
  EXPECT_EQ(report->recall_at.at(2).hits, 3);
  EXPECT_EQ(report->recall_at.at(20).hits, 3);
  EXPECT_EQ(report->recall_at.at(20).total, 4);
  // RMSE 1 cm: the 20 mm one is wrong; the one 12 mm off too.
  EXPECT_EQ(report->rmse_recall.hits, 1);
  EXPECT_EQ(report->rmse_precision.total, 4);
  // ADD of what was found: 20 mm and, modulo symmetry, 0.
  EXPECT_NEAR(report->mean_add, 0.010, 1e-9);
  EXPECT_NEAR(report->time.median, 0.6, 1e-12);
  EXPECT_NEAR(report->time.max, 0.8, 1e-12);
}

TEST(Evaluation, AngleCountsToo) {
  const std::vector<io::BopFrame> frames = {frame(0, {{1, posed_at(0, 0.7), 1.0}})};
  for (const auto& [factor, hits] : {std::pair(0.99, 1), std::pair(1.01, 0)}) {
    const auto report = evaluate(
        frames, objects(),
        {result(0, 0, {{placement(1, posed_at(0, 0.7, factor * pi / 16), 0.9)}})}, without_bop());
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->recall.hits, hits) << factor;
  }
}

TEST(Evaluation, BreakDownsByHand) {
  const Case c = two_frames();
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->by_object.size(), 2u);
  EXPECT_EQ(report->by_object[0].name, "plain");
  EXPECT_EQ(report->by_object[0].recall.hits, 1);
  EXPECT_EQ(report->by_object[0].recall.total, 3);
  EXPECT_EQ(report->by_object[0].precision.hits, 1);
  EXPECT_EQ(report->by_object[0].precision.total, 3);
  EXPECT_EQ(report->by_object[1].recall.value(), 1);
  std::map<std::string, Ratio> visible;
  for (const Group& group : report->by_visible_fraction) visible[group.name] = group.recall;
  ASSERT_EQ(visible.size(), 3u);
  EXPECT_EQ(visible.at("0.3-0.4").hits, 0);
  EXPECT_EQ(visible.at("0.5-0.6").total, 1);
  EXPECT_EQ(visible.at("0.9-1.0").hits, 2);
  std::map<std::string, Group> distance;
  for (const Group& group : report->by_distance) distance[group.name] = group;
  EXPECT_EQ(distance.at("0.6-0.8 m").recall.total, 3);
  EXPECT_EQ(distance.at("1.2-1.4 m").precision.total, 1);
  EXPECT_EQ(distance.at("1.2-1.4 m").precision.hits, 0);
}

TEST(Evaluation, CalibrationByHand) {
  const Case c = two_frames();
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  const double brier = (0.1 * 0.1 + 0.6 * 0.6 + 0.05 * 0.05 + 0.55 * 0.55) / 4;
  EXPECT_NEAR(report->brier, brier, 1e-12);
  ASSERT_EQ(report->reliability.size(), 10u);
  EXPECT_EQ(report->reliability[9].correct.total, 2);
  EXPECT_EQ(report->reliability[9].correct.hits, 2);
  EXPECT_NEAR(report->reliability[9].mean_probability, 0.925, 1e-12);
  EXPECT_EQ(report->reliability[5].correct.total, 1);
  EXPECT_EQ(report->reliability[5].correct.hits, 0);
  // 0.95 and 0.9 share a bin and are right; 0.6 and 0.55 are false, each in a bin of its own.
  EXPECT_NEAR(report->expected_calibration_error, (2 * 0.075 + 0.6 + 0.55) / 4, 1e-12);
}

TEST(Evaluation, ThresholdCurveByHand) {
  const Case c = two_frames();
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->threshold_curve.size(), 19u);
  // Right at 0.9 and 0.95, false at 0.6 and 0.55, at 0.8 of an instance that does not count.
  const auto expect = [&](double threshold, int right, int reported) {
    const ThresholdPoint& point = report->threshold_curve[std::lround(20 * threshold) - 1];
    EXPECT_EQ(point.threshold, threshold);
    EXPECT_EQ(point.precision.hits, right) << threshold;
    EXPECT_EQ(point.precision.total, reported) << threshold;
    EXPECT_EQ(point.recall.hits, right) << threshold;
    EXPECT_EQ(point.recall.total, 4) << threshold;
    EXPECT_EQ(point.false_positives_per_frame, (reported - right) / 2.0) << threshold;
  };
  expect(0.05, 2, 4);
  expect(0.55, 2, 4);  // the threshold itself remains
  expect(0.6, 2, 3);
  expect(0.65, 2, 2);
  expect(0.9, 2, 2);
  expect(0.95, 1, 1);
}

/// Probabilities of k/100 that are right with exactly that chance: precision is the mean of those
/// above the threshold, in closed form (100 + t) / 200 for a threshold of t/100.
TEST(Evaluation, ThresholdCurveOfCalibratedProbabilities) {
  constexpr int kOfEach = 100;
  FrameOutcome frame;
  frame.truth.resize(2 * 5050);
  for (int percent = 1; percent <= 100; ++percent) {
    for (int i = 0; i < kOfEach; ++i) {
      EstimateOutcome& estimate = frame.estimates.emplace_back();
      estimate.probability = percent / 100.0;
      estimate.truth = i < percent ? 0 : -1;
    }
  }
  for (const ThresholdPoint& point : threshold_curve({frame})) {
    EXPECT_NEAR(point.precision.value(), (1 + point.threshold) / 2, 1e-12);
    const double t = 100 * point.threshold;  // right are the sum of t to 100
    EXPECT_NEAR(point.recall.value(), (5050 - t * (t - 1) / 2) / (2 * 5050), 1e-12);
  }
  EXPECT_TRUE(threshold_curve({}).front().precision.total == 0);
}

TEST(Evaluation, ExpectedCalibrationErrorByHand) {
  // 30 placements at 0.2 of which a tenth is right, 10 at 0.9 of which all are: (30 + 10) * 0.1
  // / 40.
  EXPECT_NEAR(expected_calibration_error(
                  {{0.2, 0.3, 0.2, {3, 30}}, {0.5, 0.6, 0, {}}, {0.9, 1, 0.9, {10, 10}}}),
              0.1, 1e-12);
  EXPECT_EQ(expected_calibration_error({}), 0);
}

TEST(Evaluation, CoverageByHand) {
  // Errors of 20 mm and 0 with a standard deviation of 10 mm: squared lengths 4 and 0, both within
  // the 50 % region (5.35). With 7 mm: 8.16, within 90 % (10.64) but not 50 %.
  Case c = two_frames();
  auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->coverage.size(), 3u);
  EXPECT_EQ(report->coverage[0].covered.hits, 2);
  EXPECT_EQ(report->coverage[0].covered.total, 2);
  EXPECT_NEAR(report->normalised_square, (4.0 + 0.0) / 2 / 6, 1e-9);
  c.results[0].interpretations[0].placements[0].covariance *= 0.49;
  report = evaluate(c.frames, objects(), c.results, without_bop());
  EXPECT_EQ(report->coverage[0].covered.hits, 1);
  EXPECT_EQ(report->coverage[1].covered.hits, 2);
  c.results[0].interpretations[0].placements[0].covariance.setZero();
  report = evaluate(c.frames, objects(), c.results, without_bop());
  EXPECT_EQ(report->coverage[2].covered.total, 1) << "no covariance, no count";
}

/// A thing that may turn about its z axis without a difference, reported with an error of 30 mm
/// along x and a covariance that is certain of everything but the turn.
TEST(Evaluation, CoverageOfWhatSpinsHasFiveDegreesOfFreedom) {
  EvalObjects spinning = objects();
  spinning[1].symmetry.continuous = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()}};
  // Standard deviations of 10 mm and 0.1 rad; the 22 mm error is 2.2 of them: 4.84, outside of the
  // 50 % region of 5 degrees of freedom (4.35) though inside of that of 6 (5.35).
  Case c;
  c.frames = {frame(0, {{1, posed_at(0, 0.7), 1.0}})};
  c.results = {result(0, 0.1, {{placement(1, posed_at(0.022, 0.7, 1.0), 0.9)}})};
  auto& covariance = c.results[0].interpretations[0].placements[0].covariance;
  covariance.bottomRightCorner<3, 3>() = 0.01 * Eigen::Matrix3d::Identity();
  for (const double turn_variance : {0.01, 1e6}) {  // it does not matter
    covariance(5, 5) = turn_variance;
    const auto report = evaluate(c.frames, spinning, c.results, without_bop());
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->coverage[0].covered.total, 1);
    EXPECT_EQ(report->coverage[0].covered.hits, 0);
    EXPECT_EQ(report->coverage[1].covered.hits, 1);
    EXPECT_EQ(report->outcomes[0].estimates[0].covariance_error->degrees_of_freedom, 5);
    EXPECT_NEAR(report->outcomes[0].estimates[0].covariance_error->squared, 4.84, 1e-6);
  }
}

/// The axis need not go through the object's origin: a turn then moves the origin too, and with it
/// the position is free along the circle, whose tangent at the estimate is y here.
TEST(Evaluation, CoverageAboutAnAxisBesideTheOrigin) {
  EvalObjects spinning = objects();
  spinning[1].symmetry.continuous = {{Eigen::Vector3d::UnitZ(), {0.1, 0, 0}}};
  Case c;
  c.frames = {frame(0, {{1, posed_at(0, 0.7), 1.0}})};
  c.results = {result(0, 0.1, {{placement(1, posed_at(0.01, 0.7), 0.9)}})};
  auto& covariance = c.results[0].interpretations[0].placements[0].covariance;
  // Free motion: (0, -0.1, 0; 0, 0, 1). Make it very uncertain on top of 10 mm and 10 mrad.
  Eigen::Matrix<double, 6, 1> free;
  free << 0, -0.1, 0, 0, 0, 1;
  covariance += 100 * free * free.transpose();
  const auto report = evaluate(c.frames, spinning, c.results, without_bop());
  ASSERT_TRUE(report.ok());
  EXPECT_NEAR(report->outcomes[0].estimates[0].covariance_error->squared, 1,
              1e-4);  // 10 mm along x
}

/// A ball: three degrees of freedom are left, those of its centre.
TEST(Evaluation, CoverageOfABallHasThreeDegreesOfFreedom) {
  EvalObjects ball = objects();
  ball[1].symmetry.continuous = {{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()},
                                 {Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()}};
  Case c;
  c.frames = {frame(0, {{1, posed_at(0, 0.7), 1.0}})};
  c.results = {result(0, 0.1, {{placement(1, posed_at(0.015, 0.7), 0.9)}})};
  const auto report = evaluate(c.frames, ball, c.results, without_bop());
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->outcomes[0].estimates[0].covariance_error->degrees_of_freedom, 3);
  EXPECT_NEAR(report->outcomes[0].estimates[0].covariance_error->squared, 2.25, 1e-9);
  EXPECT_EQ(report->coverage[0].covered.hits, 1);  // 2.366
}

TEST(Evaluation, OpenPosesByHand) {
  // A plain object turned by a quarter of a turn; a second one that is not there.
  Placement first = placement(1, posed_at(0, 0.7), 0.4);
  first.alternatives = {{posed_at(0.01, 0.7, pi / 2), 0.25}, {posed_at(0, 0.7, pi), 0.22}};
  Placement second = placement(1, posed_at(0.5, 0.7), 0.4);
  second.alternatives = {{posed_at(0.5, 0.7, pi), 0.5}};
  Placement third = placement(1, posed_at(-0.5, 0.7), 0.9);
  const auto report =
      evaluate({frame(0, {{1, posed_at(0, 0.7, pi / 2), 1.0}, {1, posed_at(-0.5, 0.7), 1.0}})},
               objects(), {result(0, 0.4, {{first, second, third}})}, without_bop());
  ASSERT_TRUE(report.ok()) << report.status().message;
  const OpenPoses& open = report->open_poses;
  EXPECT_EQ(open.held.hits, 1);
  EXPECT_EQ(open.held.total, 1) << "of an object that is there, with alternatives";
  EXPECT_EQ(open.own.hits, 0);
  EXPECT_EQ(open.weights[5].correct.total, 1) << "what the alternatives leave";
  EXPECT_EQ(open.weights[5].correct.hits, 0);
  EXPECT_NEAR(open.weights[5].mean_probability, 0.53, 1e-12);
  EXPECT_EQ(open.weights[2].correct.hits, 1);
  EXPECT_EQ(open.weights[2].correct.total, 2);
  EXPECT_NE(report_text(*report).find("placements with alternatives"), std::string::npos);
  // The first finds the one by an alternative, the third the other.
  EXPECT_EQ(report->recall_at.at(1).hits, 1);
  EXPECT_EQ(report->among_alternatives_at.at(1).hits, 2);
  EXPECT_EQ(report->among_alternatives_at.at(1).total, 2);
}

TEST(Evaluation, AmongAlternativesCountsFromItsInterpretation) {
  Placement away = placement(1, posed_at(0, 0.7, pi / 2), 0.4);
  Placement open = away;
  open.alternatives = {{posed_at(0, 0.7), 0.3}};
  Placement other = open;
  other.model_number = 2;  // the alternative of another object says nothing
  const auto report = evaluate({frame(0, {{1, posed_at(0, 0.7), 1.0}})}, objects(),
                               {result(0, 0.4, {{away}, {other}, {open}})}, without_bop());
  ASSERT_TRUE(report.ok()) << report.status().message;
  EXPECT_EQ(report->among_alternatives_at.at(2).hits, 0);
  EXPECT_EQ(report->among_alternatives_at.at(3).hits, 1);
  EXPECT_EQ(report->recall_at.at(20).hits, 0);
}

TEST(Evaluation, FalseReportsWhereNothingIs) {
  // An empty frame with two reports, one without, one whose only instance is too hidden to count
  // and was found all the same, and one with an object.
  Case c;
  c.frames = {frame(0, {}), frame(1, {}), frame(2, {{1, posed_at(0, 0.7), 0.05}}),
              frame(3, {{1, posed_at(0, 0.7), 0.75}})};
  c.results = {
      result(0, 0.1, {{placement(1, posed_at(0, 0.7), 0.55), placement(2, posed_at(0, 0.7), 0.6)}}),
      result(1, 0.1, {{}}), result(2, 0.1, {{placement(1, posed_at(0, 0.7), 0.9)}}),
      result(3, 0.1, {{placement(2, posed_at(0, 0.7), 0.7)}})};
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->false_reports.free_frames, 3);
  EXPECT_EQ(report->false_reports.frames_with_report, 1);
  EXPECT_EQ(report->false_reports.reports, 2);
  EXPECT_EQ(report->visible_tenths[0], 1);
  EXPECT_EQ(report->visible_tenths[7], 1);
  EXPECT_NEAR(report->median_visible_fraction, 0.4, 1e-12);
  EXPECT_NE(report_text(*report).find("1 of them with 2 false positives"), std::string::npos);

  c.results.resize(2);
  const auto nothing = evaluate_nothing_there(c.results);
  ASSERT_TRUE(nothing.ok()) << nothing.status().message;
  EXPECT_EQ(nothing->precision.hits, 0);
  EXPECT_EQ(nothing->precision.total, 2);
  EXPECT_EQ(nothing->false_reports.reports, 2);
  EXPECT_EQ(nothing->reliability[5].correct.total, 1);
  EXPECT_EQ(nothing->by_object.size(), 2u);
  // Two false positives, of 0.55 and 0.6, in two frames.
  EXPECT_EQ(nothing->threshold_curve[10].false_positives_per_frame, 1);    // 0.55
  EXPECT_EQ(nothing->threshold_curve[11].false_positives_per_frame, 0.5);  // 0.6
  EXPECT_EQ(nothing->threshold_curve[12].false_positives_per_frame, 0);
}

TEST(Evaluation, TellsHowFarItIs) {
  const Case c = two_frames();
  std::vector<int> seen;
  ASSERT_TRUE(evaluate(c.frames, objects(), c.results, without_bop(), [&seen](int done) {
                seen.push_back(done);
              }).ok());
  EXPECT_EQ(seen, (std::vector<int>{1, 2}));
}

TEST(Evaluation, MissingFramesCountAsNothingFound) {
  Case c = two_frames();
  c.results.resize(1);
  const auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->recall.total, 4);
  EXPECT_EQ(report->time.frames, 1);
}

TEST(Evaluation, RefusesWhatDoesNotFit) {
  Case c = two_frames();
  c.results[0].im_id = 77;
  EXPECT_EQ(evaluate(c.frames, objects(), c.results).status().code, StatusCode::invalid_argument);
  c = two_frames();
  c.results[0].interpretations[0].placements[0].model_number = 5;
  EXPECT_EQ(evaluate(c.frames, objects(), c.results).status().code, StatusCode::invalid_argument);
  c = two_frames();
  c.frames[1].has_truth = false;
  EXPECT_EQ(evaluate(c.frames, objects(), c.results).status().code, StatusCode::invalid_argument);
}

/// One frame on disk with a cube before a wall of nothing, seen at exactly its depth.
TEST(Evaluation, BopErrorsByHand) {
  const test::TemporaryFolder folder;
  Frame image;
  image.camera = {64, 48, 60, 60, 31.5, 23.5};
  image.depth.assign(64 * 48, 0.0f);
  io::BopSceneWriter writer(folder.path(), "test", 1);
  io::BopInstanceRecord truth;
  truth.obj_id = 1;
  truth.camera_from_object = posed_at(0, 0.7);
  ASSERT_TRUE(writer.add(0, image, {truth}).ok());
  ASSERT_TRUE(writer.finish().ok());
  const auto frames = io::read_bop_frames(folder.path(), "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;

  const auto exact =
      evaluate(*frames, objects(), {result(0, 0, {{placement(1, posed_at(0, 0.7), 0.9)}})});
  ASSERT_TRUE(exact.ok()) << exact.status().message;
  EXPECT_EQ(exact->mssd, 1);
  EXPECT_EQ(exact->mspd, 1);
  EXPECT_EQ(exact->vsd, 1);
  EXPECT_EQ(exact->average_recall, 1);
  EXPECT_EQ(exact->add_recall.hits, 1);

  // 40 mm to the side: 0.231 diameters, so MSSD is right at 0.25, 0.30 ... 0.50: 6 of 10. The near
  // face is at 0.65 m: 60 * 40 / 650 = 3.69 pixels, at a width of 64 as good as 36.9 of 640: right
  // under 40, 45 and 50: 3 of 10. ADD is 0.231 diameters: wrong.
  const auto off =
      evaluate(*frames, objects(), {result(0, 0, {{placement(1, posed_at(0.04, 0.7), 0.9)}})});
  ASSERT_TRUE(off.ok());
  EXPECT_NEAR(off->mssd, 0.6, 1e-12);
  EXPECT_NEAR(off->mspd, 0.3, 1e-12);
  EXPECT_EQ(off->add_recall.hits, 0);
  EXPECT_NEAR(off->average_recall, (off->vsd + off->mssd + off->mspd) / 3, 1e-12);
  // 15 mm deeper: the silhouettes are the same 10 x 10 pixels, the front faces lie 0.087 diameters
  // apart: VSD is 1 for the first tolerance and 0 for the nine others.
  const auto deep =
      evaluate(*frames, objects(), {result(0, 0, {{placement(1, posed_at(0, 0.715), 0.9)}})});
  EXPECT_NEAR(deep->vsd, 0.9, 1e-12);

  // BOP takes as many estimates of an object as there are instances: the most probable.
  const auto two = evaluate(
      *frames, objects(),
      {result(0, 0,
              {{placement(1, posed_at(0, 0.7), 0.5), placement(1, posed_at(0.5, 0.7), 0.9)}})});
  EXPECT_EQ(two->average_recall, 0);
}

TEST(Report, TextAndJson) {
  const Case c = two_frames();
  auto report = evaluate(c.frames, objects(), c.results, without_bop());
  ASSERT_TRUE(report.ok());
  EXPECT_NE(report_text(*report).find("50.0 % (2/4)"), std::string::npos);
  const auto json = nlohmann::json::parse(report_json(*report));
  EXPECT_EQ(json.at("recall_at").at("2").at("hits"), 3);
  EXPECT_EQ(json.at("precision").at("value"), 0.5);
  EXPECT_EQ(json.at("threshold_curve").size(), 19u);
  EXPECT_EQ(json.at("threshold_curve")[11].at("precision").at("total"), 3);
  EXPECT_NE(report_text(*report).find("0.5" + std::string(23, ' ') + "50.0 % (2/4)"),
            std::string::npos);
  EXPECT_FALSE(report_text(EvaluationReport{}).empty()) << "nothing at all";
}

TEST(Evaluation, DoesNotDependOnThreads) {
  const Case c = two_frames();
  EvaluationOptions options = without_bop();
  options.num_threads = 1;
  const auto one = evaluate(c.frames, objects(), c.results, options);
  options.num_threads = 4;
  const auto four = evaluate(c.frames, objects(), c.results, options);
  ASSERT_TRUE(one.ok() && four.ok());
  EXPECT_EQ(report_json(*one), report_json(*four));
}

}  // namespace
}  // namespace bpa::eval
