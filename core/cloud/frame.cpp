// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/frame.hpp"

#include <sstream>

namespace bpa {
namespace {

constexpr float kMaxDepth = 20.0f;
constexpr std::size_t kMinValidPixels = 500;

Status check_size(const char* field, std::size_t size, std::size_t expected, const char* what) {
  if (size == expected) return {};
  std::ostringstream text;
  text << "frame " << field << " has " << size << " values; it must have " << expected << " ("
       << what << " of the camera)";
  return invalid_argument(text.str());
}

Status check_roi(const Frame& frame) {
  const RegionOfInterest& roi = frame.roi;
  if (roi.empty() || (roi.x >= 0 && roi.y >= 0 && roi.width <= frame.camera.width - roi.x &&
                      roi.height <= frame.camera.height - roi.y)) {
    return {};
  }
  std::ostringstream text;
  text << "frame roi " << roi.width << "x" << roi.height << " at (" << roi.x << ", " << roi.y
       << ") leaves the image of " << frame.camera.width << "x" << frame.camera.height
       << "; it must lie inside";
  return invalid_argument(text.str());
}

}  // namespace

Status validate(const Frame& frame) {
  if (Status status = validate(frame.camera); !status.ok()) return status;
  const auto pixels =
      static_cast<std::size_t>(frame.camera.width) * static_cast<std::size_t>(frame.camera.height);
  const char* one = "width x height";
  if (Status s = check_size("depth", frame.depth.size(), pixels, one); !s.ok()) return s;
  if (!frame.color.empty()) {
    if (Status s = check_size("color", frame.color.size(), 3 * pixels, "3 x width x height");
        !s.ok())
      return s;
  }
  if (!frame.mask.empty()) {
    if (Status s = check_size("mask", frame.mask.size(), pixels, one); !s.ok()) return s;
  }
  if (!frame.background.empty()) {
    if (Status s = check_size("background", frame.background.size(), pixels, one); !s.ok())
      return s;
  }
  if (Status s = check_roi(frame); !s.ok()) return s;
  std::size_t valid = 0;
  for (const float z : frame.depth) {
    if (z > 0 && z <= kMaxDepth && ++valid == kMinValidPixels) return {};
  }
  std::ostringstream text;
  text << "frame depth has " << valid << " valid pixels; it must have at least " << kMinValidPixels
       << " with a depth in (0, " << kMaxDepth << "] m (0 and NaN mean no depth)";
  return invalid_argument(text.str());
}

void clean_depth(Frame& frame) {
  // Without a branch, and each is written, so that the compiler makes vectors of it.
  for (float& z : frame.depth) z = int{z > 0} & int{z <= kMaxDepth} ? z : 0.0f;
}

}  // namespace bpa
