// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/modeling/posed_view.hpp"

namespace bpa::modeling {
namespace {

// Errors drawn from a known law, binned: the fit finds the law again.
TEST(NoiseFit, FindsTheLawOfTheErrors) {
  const NoiseCurve truth{0.0014, 0.006, 0.006, 0.002, 0.009, 1.15, 0.12};
  RandomStream random(11);
  std::vector<NoiseBin> bins;
  for (double e = 0.0005; e < 0.03; e += 0.001) {
    for (double a = 0.05; a < 1.5; a += 0.1) {
      NoiseBin bin{e, a, 0, 0};
      double squares = 0;
      for (int i = 0; i < 300; ++i) squares += std::pow(truth(e, a) * random.normal(), 2);
      bin.count = 300;
      bin.sigma = std::sqrt(squares / bin.count);
      bins.push_back(bin);
    }
  }
  const NoiseCurve fit = fit_noise_curve(bins, usual_noise().range);
  for (double e = 0; e < 0.03; e += 0.003) {
    for (double a = 0; a < 1.5; a += 0.15)
      EXPECT_NEAR(fit(e, a) / truth(e, a), 1, 0.06) << e << " " << a;
  }
  EXPECT_NEAR(fit.edge_place, truth.edge_place, 0.001);
  EXPECT_NEAR(fit.angle_place, truth.angle_place, 0.1);
}

TEST(NoiseFit, OfTooLittleStaysWhereItStarts) {
  const NoiseCurve start = usual_noise().normal;
  std::vector<NoiseBin> bins(6, NoiseBin{0.01, 0.5, 0.3, 100});
  EXPECT_EQ(fit_noise_curve(bins, start).floor, start.floor);
  bins.assign(50, NoiseBin{0.01, 0.5, 0.3, 5});
  EXPECT_EQ(fit_noise_curve(bins, start).floor, start.floor);
  EXPECT_EQ(fit_noise_curve({}, start).edge_place, start.edge_place);
}

}  // namespace
}  // namespace bpa::modeling
