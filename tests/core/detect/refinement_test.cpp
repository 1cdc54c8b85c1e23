// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/detect/refinement.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include <gtest/gtest.h>

#include "core/detect/stages.hpp"
#include "core/model/model_index.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa::detect {
namespace {

constexpr double kDegree = M_PI / 180;

class RefinementOf : public test::LScene {
 protected:
  static DetectOptions with_pairs(int count) {
    DetectOptions options;
    options.round_two.max_pairs = count;
    return options;
  }
  static RefinementOptions long_run() {
    RefinementOptions options;
    options.iterations = 20;
    options.max_points = 1024;
    return options;
  }
};

TEST_F(RefinementOf, CleanDataConvergesToTheTruth) {
  const SceneFeatures scene = features_of(everything());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Pose start = test::disturbed(l_truth_, 0.01, 5 * kDegree, seed);
    const Refinement refined = refine_pose(scene, *l_, start, long_run());
    const PoseError error = pose_error(refined.frame_from_object, l_truth_);
    EXPECT_LT(error.position, 0.001);
    EXPECT_LT(error.angle, 0.7 * kDegree);
    EXPECT_GT(refined.num_correspondences, 200);
  }
}

TEST_F(RefinementOf, NoisyDataComesNear) {
  const SceneFeatures scene = features_of(everything(), 1);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Pose start = test::disturbed(l_truth_, 0.01, 5 * kDegree, seed);
    const PoseError error =
        pose_error(refine_pose(scene, *l_, start, long_run()).frame_from_object, l_truth_);
    EXPECT_LT(error.position, 0.002);
    EXPECT_LT(error.angle, 1.5 * kDegree);
  }
}

TEST_F(RefinementOf, InformationIsSymmetricAndPositive) {
  const SceneFeatures scene = features_of(everything());
  const Refinement refined = refine_pose(scene, *l_, l_truth_, {});
  EXPECT_TRUE(refined.information.isApprox(refined.information.transpose(), 1e-5));
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(refined.information);
  EXPECT_GT(solver.eigenvalues()[0], 0);
  // Three faces are seen: a millimetre in any direction is noticed.
  EXPECT_GT(refined.information.topLeftCorner(3, 3).eigenvalues().real().minCoeff(), 1e6);
}

TEST_F(RefinementOf, FarFromEverythingItStaysWhereItIs) {
  const SceneFeatures scene = features_of(everything());
  Pose start = l_truth_;
  start.translation.z() -= 0.3;
  const Refinement refined = refine_pose(scene, *l_, start, {});
  EXPECT_LT(refined.num_correspondences, 6);
  EXPECT_LT(pose_error(refined.frame_from_object, start).position, 1e-6);
  EXPECT_TRUE(is_valid(refined.frame_from_object));
  const Pose behind{start.rotation, {0, 0, -1}};
  EXPECT_EQ(refine_pose(scene, *l_, behind, {}).num_correspondences, 0);
  const Pose aligned = align_to_surface(scene, *l_, behind, 0.03f, 0, with_pairs(12));
  EXPECT_EQ(aligned.translation, behind.translation);
}

TEST_F(RefinementOf, AlignmentByBpaComesNearer) {
  const SceneFeatures scene = features_of(everything());
  double before = 0, after = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Pose start = test::disturbed(l_truth_, 0.015, 8 * kDegree, seed);
    const Pose aligned = align_to_surface(scene, *l_, start, 0.03f, seed, with_pairs(30));
    ASSERT_TRUE(is_valid(aligned));
    before += pose_error(start, l_truth_).angle;
    after += pose_error(aligned, l_truth_).angle;
  }
  EXPECT_LT(after, 0.7 * before);
}

TEST_F(RefinementOf, WithoutSegmentsAllSurfaceIsAlignedTo) {
  SceneFeatures scene = features_of(everything());
  for (std::int32_t& label : scene.segmentation.labels.pixels) label = -1;  // no super-pixels
  DetectOptions all_surface = with_pairs(30);
  all_surface.align.use_segments = false;
  double before = 0, after = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Pose start = test::disturbed(l_truth_, 0.015, 8 * kDegree, seed);
    const Pose sampled = align_to_surface(scene, *l_, start, 0.03f, seed, with_pairs(30));
    EXPECT_EQ(sampled.translation, start.translation) << "nothing to align to";
    const Pose aligned = align_to_surface(scene, *l_, start, 0.03f, seed, all_surface);
    before += pose_error(start, l_truth_).angle;
    after += pose_error(aligned, l_truth_).angle;
  }
  EXPECT_LT(after, 0.7 * before);
}

TEST_F(RefinementOf, WithoutEdgesIsAsIfTheModelHadNone) {
  const SceneFeatures scene = features_of(everything());
  ObjectModel smooth = *l_;
  const auto index = std::make_shared<ModelIndex>();  // what alignment reads
  index->check = l_->index->check;
  index->views = l_->index->views;
  for (ModelView& view : index->views) view.edges = {};
  smooth.index = index;
  DetectOptions no_edges;
  no_edges.align.use_edges = false;
  int moved_by_edges = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Pose start = test::disturbed(l_truth_, 0.01, 5 * kDegree, seed);
    const Pose all = align_to_surface(scene, *l_, start, 0.03f, seed);
    const Pose left_out = align_to_surface(scene, *l_, start, 0.03f, seed, no_edges);
    const Pose none_there = align_to_surface(scene, smooth, start, 0.03f, seed);
    EXPECT_EQ(left_out.translation, none_there.translation);
    EXPECT_EQ(left_out.rotation.coeffs(), none_there.rotation.coeffs());
    moved_by_edges += all.translation != left_out.translation;
  }
  EXPECT_GT(moved_by_edges, 10);
}

TEST_F(RefinementOf, SameStartSameEnd) {
  const SceneFeatures scene = features_of(everything(), 1);
  const Pose start = test::disturbed(l_truth_, 0.01, 5 * kDegree, 3);
  const Pose first = align_to_surface(scene, *l_, start, 0.03f, 7);
  const Pose second = align_to_surface(scene, *l_, start, 0.03f, 7);
  EXPECT_EQ(first.translation, second.translation);
  EXPECT_EQ(first.rotation.coeffs(), second.rotation.coeffs());
}

}  // namespace
}  // namespace bpa::detect
