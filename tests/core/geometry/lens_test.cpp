// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/lens.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(Lens, ItsModelHasANameAndANumberOfCoefficients) {
  const auto code = [](const char* model, std::size_t count) {
    return lens_of(model, std::vector<double>(count, 0.01)).status().code;
  };
  for (const char* name : {"plumb_bob", "Brown Conrady", "radtan"}) {
    EXPECT_EQ(code(name, 5), StatusCode::ok) << name;
    EXPECT_EQ(code(name, 8), StatusCode::invalid_argument) << name;
  }
  for (const char* name : {"rational_polynomial", ""}) {
    EXPECT_EQ(code(name, 8), StatusCode::ok) << name;
    EXPECT_EQ(code(name, 12), StatusCode::invalid_argument) << name;
  }
  for (const char* name : {"equidistant", "fisheye", "Kannala Brandt4"}) {
    EXPECT_EQ(code(name, 4), StatusCode::ok) << name;
    EXPECT_EQ(code(name, 5), StatusCode::invalid_argument) << name;
    EXPECT_TRUE(lens_of(name, {0.1})->equidistant);
  }
  const Status other = lens_of("inverse_brown_conrady", {0.1}).status();
  EXPECT_EQ(other.code, StatusCode::unsupported);
  EXPECT_NE(other.message.find("\"inverse_brown_conrady\""), std::string::npos);
  EXPECT_EQ(lens_of("plumb_bob", {0, std::nan("")}).status().code, StatusCode::invalid_argument);
}

TEST(Lens, CoefficientsOfZeroAreNoneWhateverTheModel) {
  for (const char* name : {"", "none", "inverse_brown_conrady", "equidistant"}) {
    EXPECT_TRUE(lens_of(name, std::vector<double>(14, 0.0))->coefficients.empty()) << name;
  }
  EXPECT_EQ(lens_of("rational_polynomial", {0.1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})->coefficients,
            std::vector<double>{0.1});
}

/// By definition: the distance from the middle is the angle to the axis, and its polynomial.
TEST(Lens, EquidistantIsAPolynomialOfTheAngle) {
  const Lens fisheye = *lens_of("equidistant", {0.1, -0.02, 0.003, 0.0005});
  for (const double degrees : {0.0, 1.0, 20.0, 60.0, 80.0}) {
    const double t = degrees * M_PI / 180;
    const double expected = t + 0.1 * std::pow(t, 3) - 0.02 * std::pow(t, 5) +
                            0.003 * std::pow(t, 7) + 0.0005 * std::pow(t, 9);
    const Eigen::Vector2d seen = distort(fisheye, 0.6 * std::tan(t), -0.8 * std::tan(t));
    EXPECT_NEAR(seen.x(), 0.6 * expected, 1e-12);
    EXPECT_NEAR(seen.y(), -0.8 * expected, 1e-12);
  }
}

TEST(Lens, PlumbBobIsThatOfTheCoefficients) {
  EXPECT_EQ(distort(*lens_of("plumb_bob", {0.2, -0.1}), 0.3, 0.4),
            distort(std::vector<double>{0.2, -0.1}, 0.3, 0.4));
}

}  // namespace
}  // namespace bpa
