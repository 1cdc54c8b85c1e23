// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/frame.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "core/base/concat.hpp"

namespace bpa {
namespace {

constexpr float kMaxDepth = 20.0f;
constexpr std::size_t kMinValidPixels = 500;

Status check_size(const Frame& frame, const char* field, std::size_t size, std::size_t channels) {
  const auto expected = channels * static_cast<std::size_t>(frame.camera.width) *
                        static_cast<std::size_t>(frame.camera.height);
  if (size == expected) return {};
  return invalid_argument("frame ", field, " has ", size, " values; it must have ", expected, " (",
                          channels == 1 ? "" : "3 x ", "width x height of the camera)");
}

Status check_roi(const Frame& frame) {
  const RegionOfInterest& roi = frame.roi;
  if (roi.empty() || (roi.x >= 0 && roi.y >= 0 && roi.width <= frame.camera.width - roi.x &&
                      roi.height <= frame.camera.height - roi.y)) {
    return {};
  }
  return invalid_argument("frame roi ", roi.width, "x", roi.height, " at (", roi.x, ", ", roi.y,
                          ") leaves the image of ", frame.camera.width, "x", frame.camera.height,
                          "; it must lie inside");
}

}  // namespace

Status validate(const Frame& frame) {
  if (Status status = validate(frame.camera); !status.ok()) return status;
  if (Status s = check_size(frame, "depth", frame.depth.size(), 1); !s.ok()) return s;
  const std::tuple<const char*, const std::vector<std::uint8_t>&, std::size_t> optional[] = {
      {"color", frame.color, 3}, {"mask", frame.mask, 1}, {"background", frame.background, 1}};
  for (const auto& [field, values, channels] : optional) {
    if (values.empty()) continue;
    if (Status s = check_size(frame, field, values.size(), channels); !s.ok()) return s;
  }
  if (Status s = check_roi(frame); !s.ok()) return s;
  std::size_t valid = 0;
  for (const float z : frame.depth) {
    if (z > 0 && z <= kMaxDepth && ++valid == kMinValidPixels) return {};
  }
  return invalid_argument("frame depth has ", valid, " valid pixels; it must have at least ",
                          kMinValidPixels, " with a depth in (0, ", kMaxDepth,
                          "] m (0 and NaN mean no depth)");
}

ColorContent color_content(const Frame& frame) {
  // Levels that 99 % of the pixels span: 0 in a grey image. Chosen by hand: in 12 real colour
  // images more than half of the pixels are farther than 8 levels from grey.
  constexpr std::ptrdiff_t kNoise = 16;
  constexpr std::size_t kStep = 7;                       // pixels
  std::array<std::array<std::size_t, 511>, 3> counts{};  // red and blue less green, and green
  std::size_t total = 0;
  for (std::size_t i = 0; i + 2 < frame.color.size(); i += 3 * kStep, ++total) {
    const int green = frame.color[i + 1];
    ++counts[0][255 + frame.color[i] - green];
    ++counts[1][255 + frame.color[i + 2] - green];
    ++counts[2][green];
  }
  const auto varies = [total](const auto& count) {
    const auto end_of_tail = [total](auto begin, auto end) {
      std::size_t sum = 0;
      return std::find_if(begin, end, [&](std::size_t n) { return 200 * (sum += n) > total; }) -
             begin;
    };
    return end_of_tail(count.begin(), count.end()) + end_of_tail(count.rbegin(), count.rend()) +
               kNoise <
           std::ssize(count) - 1;
  };
  if (varies(counts[0]) || varies(counts[1])) return ColorContent::hues;
  return varies(counts[2]) ? ColorContent::shades : ColorContent::none;
}

void clean_depth(Frame& frame) {
  // Without a branch, and each is written, so that the compiler makes vectors of it.
  for (float& z : frame.depth) z = int{z > 0} & int{z <= kMaxDepth} ? z : 0.0f;
}

Frame crop(const Frame& frame, const RegionOfInterest& part) {
  Frame out;
  out.camera = frame.camera;
  out.camera.width = part.width;
  out.camera.height = part.height;
  out.camera.cx -= part.x;
  out.camera.cy -= part.y;
  for (int v = part.y; v < part.y + part.height; ++v) {
    const std::ptrdiff_t from = std::ptrdiff_t{v} * frame.camera.width + part.x;
    const std::ptrdiff_t to = from + part.width;
    out.depth.insert(out.depth.end(), frame.depth.begin() + from, frame.depth.begin() + to);
    if (frame.color.empty()) continue;
    out.color.insert(out.color.end(), frame.color.begin() + 3 * from, frame.color.begin() + 3 * to);
  }
  return out;
}

}  // namespace bpa
