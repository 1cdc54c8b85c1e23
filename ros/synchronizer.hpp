// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "idl/wire/msg/sensor_msgs.hpp"
#include "idl/wire/time.hpp"
#include "ros/frames.hpp"

namespace bpa::ros {

inline constexpr double kSyncTolerance_ms = 10;
inline constexpr std::size_t kSyncQueue = 10;

struct SynchronizerOptions {
  bool with_color = true;  ///< Wait for a colour image for each depth image.
  /// Largest difference of stamps within one set; 0: equal stamps only.
  std::int64_t tolerance_ns = static_cast<std::int64_t>(1e6 * kSyncTolerance_ms);
  std::size_t queue = kSyncQueue;  ///< Messages of one stream that may wait.
};

/// What became of the messages so far.
struct SyncCounts {
  std::uint64_t exact = 0;                ///< Sets whose stamps are all equal.
  std::uint64_t approximate = 0;          ///< Other sets.
  std::uint64_t depth_without_color = 0;  ///< Depth images with no colour image near enough.
  std::uint64_t depth_without_info = 0;   ///< Depth images with no camera info near enough.
  std::uint64_t color_unused = 0;         ///< Colour images that no depth image wanted.
  std::uint64_t restarts = 0;             ///< A clock jumped back; everything waiting was dropped.
  /// Smallest difference of stamps that a depth image was given up for; 0 before the first.
  std::int64_t nearest_miss_ns = 0;
};

/// Synchronises colour images, depth images and camera infos of one camera by their stamps.
///
/// A depth image goes with the messages of the same stamp as soon as they arrive. Otherwise it goes
/// with the nearest ones within the tolerance, the earlier of two equally near. It waits until each
/// stream has reached its stamp and so cannot bring a nearer one. Every message is used once at
/// most. Sets come out in the order of their stamps. Not locked.
class Synchronizer {
 public:
  explicit Synchronizer(const SynchronizerOptions& options) : options_(options) {}

  /// For the messages from now on.
  void set_options(const SynchronizerOptions& options) { options_ = options; }

  /// Call next() after each until it returns nothing.
  void add_color(AnyImage&& image) {
    add(color_, std::move(image));
    while (color_.items.size() > options_.queue) {
      color_.items.pop_front();
      ++counts_.color_unused;
    }
  }
  void add_depth(AnyImage&& image) {
    add(depth_, std::move(image));
    while (depth_.items.size() > options_.queue) {
      const std::int64_t stamp = depth_.items.front().stamp_ns;
      give_up_depth(choose(color_, stamp), choose(info_, stamp));
    }
  }
  void add_info(wire::sensor_msgs::CameraInfo&& info) {
    add(info_, std::move(info));
    while (info_.items.size() > options_.queue) info_.items.pop_front();
  }

  /// The next complete set; nothing while none is complete.
  std::optional<CameraImages> next() {
    while (!depth_.items.empty()) {
      const std::int64_t stamp = depth_.items.front().stamp_ns;
      const Choice info = choose(info_, stamp);
      const Choice color =
          options_.with_color ? choose(color_, stamp) : Choice{Choice::Kind::take, 0, 0};
      if (color.kind == Choice::Kind::none || info.kind == Choice::Kind::none) {
        give_up_depth(color, info);
        continue;
      }
      if (color.kind == Choice::Kind::wait || info.kind == Choice::Kind::wait) return std::nullopt;
      return take(color, info);
    }
    return std::nullopt;
  }

  const SyncCounts& counts() const { return counts_; }

 private:
  template <class T>
  struct Stream {
    struct Item {
      std::int64_t stamp_ns;
      std::shared_ptr<const T> message;
    };
    std::deque<Item> items;              ///< By stamp.
    std::int64_t newest_ns = INT64_MIN;  ///< The latest stamp seen.
  };
  /// What a stream has for a depth image.
  struct Choice {
    enum class Kind { wait, take, none } kind = Kind::wait;
    std::size_t index = 0;
    std::int64_t gap_ns = 0;  ///< To the nearest one; INT64_MAX when there is none.
  };

  /// A stream that goes back by more than this has started again (a bag played twice, say).
  static constexpr std::int64_t kRestartNs = 1'000'000'000;

  template <class T>
  void add(Stream<T>& stream, T&& message) {
    const std::int64_t stamp = to_ns(header_of(message).stamp);
    if (stream.newest_ns != INT64_MIN && stamp < stream.newest_ns - kRestartNs) {
      ++counts_.restarts;
      color_ = {};
      depth_ = {};
      info_ = {};
    }
    stream.newest_ns = std::max(stream.newest_ns, stamp);
    const auto place =
        std::ranges::upper_bound(stream.items, stamp, {}, &Stream<T>::Item::stamp_ns);
    stream.items.insert(place, {stamp, std::make_shared<const T>(std::move(message))});
  }

  template <class T>
  Choice choose(const Stream<T>& stream, std::int64_t stamp_ns) const {
    Choice choice{Choice::Kind::wait, 0, INT64_MAX};
    for (std::size_t i = 0; i < stream.items.size(); ++i) {
      const std::int64_t gap_ns = std::abs(stream.items[i].stamp_ns - stamp_ns);
      if (gap_ns < choice.gap_ns) choice = {Choice::Kind::wait, i, gap_ns};
    }
    const bool complete = choice.gap_ns == 0 || stream.newest_ns >= stamp_ns;
    if (choice.gap_ns <= options_.tolerance_ns && complete) {
      choice.kind = Choice::Kind::take;
    } else if (stream.newest_ns > stamp_ns + options_.tolerance_ns) {
      choice.kind = Choice::Kind::none;
    }
    return choice;
  }

  void give_up_depth(const Choice& color, const Choice& info) {
    const bool no_color = options_.with_color && color.kind != Choice::Kind::take;
    const std::int64_t miss = no_color ? color.gap_ns : info.gap_ns;
    ++(no_color ? counts_.depth_without_color : counts_.depth_without_info);
    if (miss != INT64_MAX && (counts_.nearest_miss_ns == 0 || miss < counts_.nearest_miss_ns)) {
      counts_.nearest_miss_ns = miss;
    }
    depth_.items.pop_front();
  }

  /// Takes the message out, and drops the earlier ones.
  template <class T>
  static std::shared_ptr<const T> take(Stream<T>& stream, std::size_t index) {
    std::shared_ptr<const T> message = std::move(stream.items[index].message);
    stream.items.erase(stream.items.begin(), stream.items.begin() + index + 1);
    return message;
  }

  CameraImages take(const Choice& color, const Choice& info) {
    ++(color.gap_ns == 0 && info.gap_ns == 0 ? counts_.exact : counts_.approximate);
    CameraImages images;
    images.depth = take(depth_, 0);
    images.info = take(info_, info.index);
    if (options_.with_color) {
      counts_.color_unused += color.index;
      images.color = take(color_, color.index);
    }
    return images;
  }

  SynchronizerOptions options_;
  SyncCounts counts_;
  Stream<AnyImage> color_;
  Stream<AnyImage> depth_;
  Stream<wire::sensor_msgs::CameraInfo> info_;
};

}  // namespace bpa::ros
