// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bpa/core/model/object_model.hpp>
#include <bpa/core/model/symmetry_search.hpp>

#include "support/meshes.hpp"

namespace bpa {
namespace {

SymmetryGroup symmetries_of(const TriangleMesh& mesh) {
  const auto source = model_source_from_mesh(mesh, "thing", 1);
  EXPECT_TRUE(source.ok());
  return find_symmetries(source->surface, source->diameter, 0);
}

TEST(SymmetrySearch, BoxHasThreeHalfTurns) {
  const SymmetryGroup group = symmetries_of(test::box_mesh({0.05f, 0.04f, 0.025f}));
  EXPECT_TRUE(group.continuous.empty());
  ASSERT_EQ(group.discrete.size(), 3u) << describe(group);
  for (const Pose& pose : group.discrete) {
    const Eigen::Vector3d v = vector_from_rotation(pose.rotation);
    EXPECT_NEAR(v.norm(), M_PI, 0.02);
    EXPECT_GT(v.normalized().cwiseAbs().maxCoeff(), std::cos(0.02)) << "about an axis of the box";
    EXPECT_LT(pose.translation.norm(), 0.002);
  }
}

TEST(SymmetrySearch, CubeHasTwentyThreeTurns) {
  const SymmetryGroup group = symmetries_of(test::box_mesh({0.04f, 0.04f, 0.04f}));
  EXPECT_EQ(group.discrete.size(), 23u) << describe(group);
}

TEST(SymmetrySearch, BeakerTurnsAboutItsAxisOnly) {
  const SymmetryGroup group = symmetries_of(test::cup_mesh(0.04, 0.003, 0.09));
  ASSERT_EQ(group.continuous.size(), 1u) << describe(group);
  EXPECT_TRUE(group.discrete.empty()) << "it has a foot and a mouth";
  EXPECT_GT(group.continuous[0].axis.z(), std::cos(0.02));
  EXPECT_LT(group.continuous[0].point.head<2>().norm(), 0.001);
}

TEST(SymmetrySearch, SphereTurnsAnyWay) {
  EXPECT_GE(symmetries_of(test::sphere_mesh(0.04)).continuous.size(), 2u);
}

TEST(SymmetrySearch, LHasOneHalfTurnAtMost) {
  // The two boxes of the L are equally wide, so that only a mirror maps it onto itself.
  const SymmetryGroup group = symmetries_of(test::l_mesh());
  EXPECT_TRUE(group.trivial()) << describe(group);
  EXPECT_EQ(describe(group), "none");
}

}  // namespace
}  // namespace bpa
