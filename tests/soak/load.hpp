// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <bpa/client.hpp>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/process.hpp"

// Those who use the server all at once. Each counts what it did; read the counts once `stop` is set
// and the thread has ended.

namespace bpa::soak {

using std::chrono::milliseconds;

/// A ROS 2 camera: three best-effort topics with the frames in turn, stamped with the time.
class CameraLoad {
 public:
  static Result<std::unique_ptr<CameraLoad>> create(const std::vector<Frame>& frames);

  /// At 10 Hz, which is more than the server can search.
  void run(const std::atomic<bool>& stop);
  /// Publishes the next frame.
  void publish();
  std::uint64_t frames() const { return frames_; }
  /// Of all three topics.
  std::uint64_t messages() const { return messages_; }

 private:
  struct Images {
    wire::sensor_msgs::Image color, depth;
    wire::sensor_msgs::CameraInfo info;
  };
  explicit CameraLoad(wire::Participant participant) : participant_(std::move(participant)) {}

  wire::Participant participant_;
  std::vector<Images> images_;
  std::optional<wire::Publisher<wire::sensor_msgs::Image>> color_, depth_;
  std::optional<wire::Publisher<wire::sensor_msgs::CameraInfo>> info_;
  std::uint64_t frames_ = 0, messages_ = 0;
};

/// An SDK client that asks for one search after another: of the camera's next frame, of its own.
struct RequestLoad {
  explicit RequestLoad(Client to) : client(std::move(to)) {}
  void run(const std::vector<Frame>& frames, const std::atomic<bool>& stop);

  Client client;
  std::uint64_t asked = 0, answered = 0, refused = 0, timed_out = 0, detections = 0;
  std::vector<double> milliseconds_each;       ///< Of those that were answered.
  std::map<std::string, std::uint64_t> other;  ///< Messages of failures that are none of these.
};

/// An SDK client that loads a model of the library under another name, and unloads it.
struct ModelLoad {
  explicit ModelLoad(Client to) : client(std::move(to)) {}
  void run(const std::string& model, const std::atomic<bool>& stop);

  Client client;
  std::uint64_t loads = 0;
  std::map<std::string, std::uint64_t> failures;  ///< Messages.
};

/// Reads /bpa/detections reliably, and takes 2 s for each.
class SlowReader {
 public:
  static Result<std::unique_ptr<SlowReader>> create();
  std::uint64_t read() const { return read_; }

 private:
  explicit SlowReader(wire::Participant participant) : participant_(std::move(participant)) {}

  wire::Participant participant_;
  std::atomic<std::uint64_t> read_{0};
  std::optional<wire::Subscriber<wire::vision_msgs::Detection3DArray>> subscriber_;
};

/// Starts bpa-client, which watches or asks for a search, and kills it after 1 to 3 s.
struct KilledClients {
  void run(const std::atomic<bool>& stop);

  std::uint64_t killed = 0, requests = 0;  ///< Requests: those who may have asked for a search.
};

}  // namespace bpa::soak
