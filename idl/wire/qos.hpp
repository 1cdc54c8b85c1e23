// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Quality of service, all of it in one place. A publisher must offer at least what a subscriber
// asks for, or they do not match: inputs ask for little, outputs offer much.

namespace bpa::wire {

enum class Reliability { best_effort, reliable };
enum class Durability { volatile_, transient_local };

struct Qos {
  Reliability reliability = Reliability::reliable;
  Durability durability = Durability::volatile_;
  int depth = 10;                ///< Newest samples kept, at least 1.
  std::int64_t lifespan_ms = 0;  ///< Older samples are not delivered; 0: no limit.
};

namespace qos {

/// Subscriptions to cameras: matches every publisher.
inline Qos sensor_input() { return {Reliability::best_effort, Durability::volatile_, 5, 0}; }
/// Subscriptions to cameras over lossy links with reliable publishers.
inline Qos reliable_input() { return {Reliability::reliable, Durability::volatile_, 5, 0}; }
/// Frames: a third of a second at 30 Hz.
inline Qos frames() { return {Reliability::reliable, Durability::volatile_, 10, 0}; }
/// Published results, markers, diagnostics: matches every subscriber.
inline Qos results() { return {Reliability::reliable, Durability::volatile_, 10, 0}; }
/// What a late subscriber must still get: vision_info, static transforms.
inline Qos latched() { return {Reliability::reliable, Durability::transient_local, 1, 0}; }
/// Both topics of a service. Of requests and replies that are on their way, those that do not fit
/// are lost without a word: a reader that misses one holds back all that follow.
inline Qos services() { return {Reliability::reliable, Durability::volatile_, 1000, 0}; }
/// /clock, as rclcpp subscribes to it.
inline Qos clock() { return {Reliability::best_effort, Durability::volatile_, 1, 0}; }
/// Events of parameters.
inline Qos parameters() { return {Reliability::reliable, Durability::volatile_, 1000, 0}; }
/// /tf.
inline Qos transforms() { return {Reliability::reliable, Durability::volatile_, 100, 0}; }
/// Subscriptions to /tf_static, as tf2_ros has them.
inline Qos static_transforms() { return {Reliability::reliable, Durability::transient_local, 100}; }
/// /rosout.
inline Qos rosout() { return {Reliability::reliable, Durability::transient_local, 1000, 10'000}; }

}  // namespace qos
}  // namespace bpa::wire
