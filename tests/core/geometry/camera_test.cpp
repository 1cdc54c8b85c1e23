// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.hpp"

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

}  // namespace
}  // namespace bpa
