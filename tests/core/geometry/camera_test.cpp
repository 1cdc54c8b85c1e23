// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace bpa {
namespace {

TEST(Camera, ProjectsWhatItUnprojects) {
  const Camera camera{640, 480, 525, 530, 319.5, 239.5};
  const Eigen::Vector2d pixel = camera.project(camera.unproject(17, 401, 0.8));
  EXPECT_NEAR(pixel.x(), 17, 1e-9);
  EXPECT_NEAR(pixel.y(), 401, 1e-9);
}

TEST(Camera, ZeroFocalLengthIsNamed) {
  const Status status = validate(Camera{640, 480, 0, 525, 319.5, 239.5});
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  EXPECT_EQ(status.message, "camera fx is 0; it must be a focal length in pixels, greater than 0");
}

TEST(Distort, BendsAsItsTermsSay) {
  const double x = 0.3, y = -0.2, r2 = 0.13;
  const auto expect = [&](const std::vector<double>& coefficients, double u, double v) {
    const Eigen::Vector2d bent = distort(coefficients, x, y);
    EXPECT_NEAR(bent.x(), u, 1e-12) << coefficients.size();
    EXPECT_NEAR(bent.y(), v, 1e-12) << coefficients.size();
  };
  expect({}, x, y);
  expect({0.1}, x * 1.013, y * 1.013);
  expect({0, 0.1}, x * 1.00169, y * 1.00169);
  expect({0, 0, 0.01}, x + 0.01 * 2 * x * y, y + 0.01 * (r2 + 2 * y * y));
  expect({0, 0, 0, 0.01}, x + 0.01 * (r2 + 2 * x * x), y + 0.01 * 2 * x * y);
  expect({0, 0, 0, 0, 0.1}, x * 1.0002197, y * 1.0002197);
  expect({0, 0, 0, 0, 0, 0.1}, x / 1.013, y / 1.013);
  expect({0, 0, 0, 0, 0, 0, 0.1}, x / 1.00169, y / 1.00169);
  expect({0, 0, 0, 0, 0, 0, 0, 0.1}, x / 1.0002197, y / 1.0002197);
}

}  // namespace
}  // namespace bpa
