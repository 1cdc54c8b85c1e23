// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "core/align/align.hpp"
#include "tests/core/align/align_problems.hpp"

// The paper's figure of objects aligned with two correspondences, as numbers: the median error of
// two oriented pairs beside position-only alignment of 2, 3 and 10 points.

namespace bpa::align {
namespace {

struct Errors {
  double position = 0;
  double angle = 0;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

Errors median_errors(int pairs_count, bool oriented, double sigma, double kappa,
                     RandomStream& random) {
  std::vector<double> positions, angles;
  for (int i = 0; i < 2000; ++i) {
    const Pose truth = random_pose(random);
    std::vector<OrientedPair> pairs;
    for (int k = 0; k < pairs_count; ++k) {
      // The model is clean; the curvature direction is as good as the normal, its sign open.
      const OrientedPoint model = random_feature(random, -1e6, -1e6);
      OrientedPair pair = draw_pair(model, truth, sigma, kappa, kappa, random);
      if (random.uniform() < 0.5) {
        pair.scene.orientation = reversed_curvature(pair.scene.orientation);
      }
      pairs.push_back(pair);
    }
    const Pose pose = oriented ? bpa_mode({.oriented = pairs}).camera_from_object
                               : icp_mode({.oriented = pairs}).camera_from_object;
    positions.push_back((pose.translation - truth.translation).norm());
    angles.push_back(rotation_angle(pose.rotation, truth.rotation));
  }
  return {median(positions), median(angles)};
}

TEST(TwoCorrespondences, LockThePose) {
  RandomStream random(1);
  std::printf(
      "noise: position mm, orientation deg | median error mm, deg:  2 oriented | positions"
      " only: 2 | 3 | 10\n");
  for (double sigma : {0.001, 0.002, 0.005, 0.010}) {
    const double kappa = -100 * std::pow(0.005 / sigma, 2);  // 8 degrees at 5 mm.
    const Errors two = median_errors(2, true, sigma, kappa, random);
    const Errors positions2 = median_errors(2, false, sigma, kappa, random);
    const Errors positions3 = median_errors(3, false, sigma, kappa, random);
    const Errors positions10 = median_errors(10, false, sigma, kappa, random);
    const double degrees = 180 / M_PI;
    std::printf("%4.0f  %4.1f | %6.2f %6.2f | %6.2f %6.2f | %6.2f %6.2f | %6.2f %6.2f\n",
                1e3 * sigma, degrees * std::sqrt(-2 / kappa), 1e3 * two.position,
                degrees * two.angle, 1e3 * positions2.position, degrees * positions2.angle,
                1e3 * positions3.position, degrees * positions3.angle, 1e3 * positions10.position,
                degrees * positions10.angle);
    // Two positions leave an angle open; two oriented pairs leave none, and do about as well as
    // three positions.
    EXPECT_GT(positions2.angle, 0.5);
    EXPECT_LT(two.angle, 0.2 * positions2.angle);
    EXPECT_LT(two.angle, 1.1 * positions3.angle);
    EXPECT_LT(two.position, 1.25 * positions3.position);
    EXPECT_LT(positions10.angle, two.angle);
  }
}

}  // namespace
}  // namespace bpa::align
