// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/camera.hpp"

#include <string>

#include "core/base/concat.hpp"

namespace bpa {
namespace {

constexpr int kMinCameraSide = 16;
constexpr int kMaxCameraSide = 8192;

}  // namespace

Status validate(const Camera& camera) {
  const auto broken = [](const char* field, auto value, const std::string& rule) {
    return invalid_argument("camera ", field, " is ", value, "; it must be ", rule);
  };
  const auto size_fits = [](int size) { return size >= kMinCameraSide && size <= kMaxCameraSide; };
  const std::string size_rule =
      concat("between ", kMinCameraSide, " and ", kMaxCameraSide, " pixels");
  if (!size_fits(camera.width)) return broken("width", camera.width, size_rule);
  if (!size_fits(camera.height)) return broken("height", camera.height, size_rule);
  const auto focal_fits = [](double focal) { return focal > 0 && focal < 1e6; };
  const char* focal_rule = "a focal length in pixels, greater than 0";
  if (!focal_fits(camera.fx)) return broken("fx", camera.fx, focal_rule);
  if (!focal_fits(camera.fy)) return broken("fy", camera.fy, focal_rule);
  const auto centre_fits = [](double at, int size) { return at > -size && at < 2 * size; };
  const char* centre_rule = "within one image size of the image";
  if (!centre_fits(camera.cx, camera.width)) return broken("cx", camera.cx, centre_rule);
  if (!centre_fits(camera.cy, camera.height)) return broken("cy", camera.cy, centre_rule);
  return {};
}

}  // namespace bpa
