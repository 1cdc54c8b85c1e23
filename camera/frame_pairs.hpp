// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace bpa::camera {

/// Puts the depth and colour frames of one device together by its own time stamps. Holds one frame
/// of each kind: a newer one takes the place of one that found no partner. `Image` is cheap to
/// move.
template <class Image>
class FramePairs {
 public:
  /// Frames belong together when their stamps differ by no more than `tolerance_us`.
  explicit FramePairs(std::int64_t tolerance_us) : tolerance_us_(tolerance_us) {}

  struct Pair {
    Image depth;
    std::int64_t depth_us = 0;
    Image color;
  };

  void add_depth(Image image, std::int64_t stamp_us) {
    if (depth_) ++unpaired_depth_;
    depth_.emplace(std::move(image), stamp_us);
  }
  void add_color(Image image, std::int64_t stamp_us) { color_.emplace(std::move(image), stamp_us); }

  /// The pair, if there is one now. Drops what is too old to find a partner.
  std::optional<Pair> take() {
    if (!depth_ || !color_) return std::nullopt;
    const std::int64_t apart = depth_->second - color_->second;
    if (apart > tolerance_us_) {
      color_.reset();
      return std::nullopt;
    }
    if (apart < -tolerance_us_) {
      depth_.reset();
      ++unpaired_depth_;
      return std::nullopt;
    }
    Pair pair{std::move(depth_->first), depth_->second, std::move(color_->first)};
    clear();
    return pair;
  }
  /// Takes the depth frame without waiting for colour.
  std::optional<std::pair<Image, std::int64_t>> take_depth() { return std::exchange(depth_, {}); }

  /// Forgets what waits (streams started again).
  void clear() {
    depth_.reset();
    color_.reset();
  }
  /// Depth frames that went away without colour.
  std::uint64_t unpaired_depth() const { return unpaired_depth_; }

 private:
  std::int64_t tolerance_us_;
  std::optional<std::pair<Image, std::int64_t>> depth_;
  std::optional<std::pair<Image, std::int64_t>> color_;
  std::uint64_t unpaired_depth_ = 0;
};

}  // namespace bpa::camera
