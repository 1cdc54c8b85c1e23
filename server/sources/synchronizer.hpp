// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "idl/wire/msg/sensor_msgs.hpp"
#include "server/convert/frames.hpp"

namespace bpa::server {

struct SynchronizerOptions {
  bool with_color = true;                  ///< Wait for a colour image for each depth image.
  std::int64_t tolerance_ns = 10'000'000;  ///< Largest difference of stamps within one set; 0:
                                           ///< equal stamps only.
  std::size_t queue = 10;                  ///< Messages of one stream that may wait.
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

/// Puts colour images, depth images and camera infos of one camera together by their stamps.
///
/// A depth image goes with the messages of the same stamp as soon as they are there. Without such,
/// it goes with the nearest ones within the tolerance, once each stream has reached the depth
/// image's stamp and so cannot bring a nearer one; of two equally near the earlier is taken. Every
/// message is used once at most and sets come out in the order of their stamps. Not locked.
class Synchronizer {
 public:
  explicit Synchronizer(const SynchronizerOptions& options) : options_(options) {}

  /// For the messages from now on.
  void set_options(const SynchronizerOptions& options) { options_ = options; }

  /// Call next() after each until it returns nothing.
  void add_color(AnyImage&& image);
  void add_depth(AnyImage&& image);
  void add_info(wire::sensor_msgs::CameraInfo&& info);

  /// The next complete set; nothing while none is complete.
  std::optional<CameraImages> next();

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

  template <class T>
  void add(Stream<T>& stream, T&& message);
  template <class T>
  Choice choose(const Stream<T>& stream, std::int64_t stamp_ns) const;
  void give_up_depth(const Choice& color, const Choice& info);
  /// Takes the message out, and drops the earlier ones.
  template <class T>
  static std::shared_ptr<const T> take(Stream<T>& stream, std::size_t index);
  CameraImages take(const Choice& color, const Choice& info);

  SynchronizerOptions options_;
  SyncCounts counts_;
  Stream<AnyImage> color_;
  Stream<AnyImage> depth_;
  Stream<wire::sensor_msgs::CameraInfo> info_;
};

}  // namespace bpa::server
