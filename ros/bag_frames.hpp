// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "idl/wire/msg/tf2_msgs.hpp"
#include "ros/bag_reader.hpp"
#include "ros/bag_topics.hpp"
#include "ros/frames.hpp"
#include "ros/synchronizer.hpp"

namespace bpa::ros {

/// Frames of a recording of ROS 2, in their order, as the server makes them of the same topics.
class BagFrames {
 public:
  /// Takes the transforms that are recorded beside the frames.
  using OnTransforms = std::function<void(const wire::tf2_msgs::TFMessage&, bool is_static)>;

  /// Messages of the first `start_s` seconds are left out, but for static transforms. Fails as
  /// open_bag() does; with not_found where no topics make frames, with invalid_argument where
  /// several could (the message lists them).
  static Result<BagFrames> open(const std::string& path, const BagTopics& topics,
                                double start_s = 0, OnTransforms on_transforms = nullptr);

  /// The next frame, or why a message makes none: later ones still may. Nothing at the end. Fails
  /// where the recording is damaged, and at its end where it held no whole frame.
  Result<std::optional<DecodedFrame>> next();

  /// The topics that are read, for people.
  const std::string& description() const { return description_; }

 private:
  BagFrames(std::unique_ptr<BagReader> reader, BagTopics topics, double start_s,
            OnTransforms on_transforms);
  void take(const BagMessage& message);
  template <class Message>
  std::optional<Message> decoded(const BagMessage& message);

  std::unique_ptr<BagReader> reader_;
  BagTopics topics_;  ///< All that are read, by name; `cloud`: of clouds or whole frames.
  OnTransforms on_transforms_;
  std::string description_;
  bool rectified_ = false;
  double start_s_;
  std::int64_t start_ns_ = 0;  ///< By the recording's clock, once its first message is read.
  bool any_frame_ = false;
  Synchronizer synchronizer_;
  std::deque<DecodedFrame> ready_;
};

}  // namespace bpa::ros
