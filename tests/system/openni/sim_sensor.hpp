// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <bpa/client.hpp>

#include "core/cloud/frame.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/temporary_folder.hpp"

// A simulated OpenNI2 sensor (libBpaSim.so in the real OpenNI2), servers that open it, and what
// other processes hear of it.

namespace bpa::support {

/// The size of everything here: small, so that two cores can do 30 Hz beside a search.
inline constexpr Camera kSimCamera{320, 240, 285, 285, 159.5, 119.5};

/// A square plate that faces the camera.
struct Plate {
  double x, y, z;  ///< Middle, metres, in the colour camera.
  double half;     ///< Half its side.
  std::array<std::uint8_t, 3> color;
};

/// Plates in front of a wall at 1.6 m, as a camera sees them that stands `offset` metres right of
/// the colour camera. Closed form: no code of the sensor or the server is involved.
inline Frame plate_frame(const std::vector<Plate>& plates, const Camera& camera, double offset) {
  Frame frame;
  frame.camera = camera;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      double z = 1.6;
      std::array<std::uint8_t, 3> color = {20, 20, 20};
      for (const Plate& plate : plates) {
        const Eigen::Vector3d p = camera.unproject(u, v, plate.z);
        const bool hit = std::abs(p.x() + offset - plate.x) < plate.half &&
                         std::abs(p.y() - plate.y) < plate.half;
        if (!hit || plate.z >= z) continue;
        z = plate.z;
        color = plate.color;
      }
      frame.depth.push_back(static_cast<float>(z));
      frame.color.insert(frame.color.end(), color.begin(), color.end());
    }
  }
  return frame;
}

/// Writes frames as the data set that the sensor shows, scene 1 of FOLDER.
inline void write_scenes(const std::string& folder, const std::vector<Frame>& frames) {
  io::BopSceneWriter writer(folder, "test", 1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(writer.add(static_cast<int>(i), frames[i], {}).ok());
  }
  ASSERT_TRUE(writer.finish().ok());
}

/// Adds the depth camera's own view of one frame, in millimetres.
inline void write_infrared(const std::string& folder, const Frame& frame, int im_id) {
  ASSERT_TRUE(io::write_file(folder + "/camera_ir.json", io::camera_json(frame.camera, 1.0)).ok());
  io::GrayImage image{frame.camera.width, frame.camera.height, {}};
  for (const float z : frame.depth) {
    image.pixels.push_back(static_cast<std::uint16_t>(std::lround(1000 * z)));
  }
  char name[32];
  std::snprintf(name, sizeof name, "/%06d.png", im_id);
  ASSERT_TRUE(io::write_gray_png(folder + "/test/000001/depth_ir" + name, image).ok());
}

/// Sets how the sensor behaves: lines of openni2_sim/sim_scenes.hpp.
inline void set_sensor(const std::string& folder, const std::string& lines = "") {
  test::spill(folder + "/sim.new", "scenes: .\n" + lines);
  std::filesystem::rename(folder + "/sim.new", folder + "/sim.yaml");
}

/// Runs a program with our copy of OpenNI2 and the sensor of a folder ("": none is configured).
inline std::vector<std::string> with_sensor(const std::string& folder,
                                            std::vector<std::string> command) {
  std::vector<std::string> all = {"/usr/bin/env", "LD_LIBRARY_PATH=" BPA_BINARY_DIR "/openni2",
                                  folder.empty() ? "BPA_SIM=" : "BPA_SIM=" + folder + "/sim.yaml"};
  all.insert(all.end(), command.begin(), command.end());
  return all;
}

/// bpa-server with a camera of its own, in this test's domain and namespace.
class SensorServer {
 public:
  SensorServer(const std::string& folder, const std::string& source,
               const std::vector<std::string>& settings, const std::string& library = "") {
    static int count = 0;
    log_path_ = scratch_folder() + "/sensor_server" + std::to_string(++count) + ".log";
    const std::string none = scratch_folder() + "/no_models";
    std::filesystem::create_directories(none);
    std::vector<std::string> command = own_command(
        "bpa-server", {"--library", library.empty() ? none : library, "--capture", source});
    std::vector<std::string> all = {"output.diagnostics=diagnostics",
                                    "output.tf=tf",
                                    "capture.color_topic=color",
                                    "capture.depth_topic=depth",
                                    "capture.color_info_topic=color_info",
                                    "capture.depth_info_topic=depth_info",
                                    "capture.points_topic=points",
                                    "capture.depth_mode=320x240@30",
                                    "capture.color_mode=320x240@30",
                                    "capture.timeout_ms=600",
                                    "capture.retry_ms=100"};
    if (library.empty()) all.push_back("capture.search=false");
    if (!folder.empty()) all.push_back("capture.record_folder=" + folder);
    all.insert(all.end(), settings.begin(), settings.end());
    for (const std::string& setting : all) {
      command.push_back("--set");
      command.push_back(setting);
    }
    process_ = std::make_unique<Process>(with_sensor(folder, command), log_path_);
  }
  /// Ends it as a user does; its exit code.
  int stop() {
    process_->signal(SIGTERM);
    return process_->wait(std::chrono::milliseconds(15000));
  }
  Process& process() { return *process_; }
  std::string log() const { return read_text(log_path_); }
  /// How many log lines hold the text.
  int said(const std::string& text) const {
    int count = 0;
    const std::string all = log();
    for (std::size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) {
      ++count;
    }
    return count;
  }
  /// Waits until the log says so for the `times`th time.
  bool wait_for(const std::string& text, int times = 1) const {
    for (int i = 0; i < 1000; ++i) {
      if (said(text) >= times) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

 private:
  std::string log_path_;
  std::unique_ptr<Process> process_;
};

/// Another process's view of one topic.
template <class T>
class Listener {
 public:
  Listener(const wire::Participant& participant, const std::string& topic, wire::Qos qos) {
    wire::SubscriberOptions options;
    options.qos = qos;
    auto subscriber = wire::Subscriber<T>::create(participant, topic, options,
                                                  [this](T&& message, const wire::SampleMeta&) {
                                                    const std::lock_guard<std::mutex> lock(mutex_);
                                                    messages_.push_back(std::move(message));
                                                    changed_.notify_all();
                                                  });
    if (subscriber.ok()) subscriber_.emplace(std::move(subscriber).value());
  }
  bool wait_for(std::size_t count, int milliseconds = 10000) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::milliseconds(milliseconds),
                             [&] { return messages_.size() >= count; });
  }
  /// Waits for a message that fits.
  std::optional<T> wait_for(const std::function<bool(const T&)>& fits, int milliseconds = 10000) {
    std::unique_lock<std::mutex> lock(mutex_);
    std::optional<T> found;
    changed_.wait_for(lock, std::chrono::milliseconds(milliseconds), [&] {
      for (const T& message : messages_) {
        if (fits(message)) found = message;
      }
      return found.has_value();
    });
    return found;
  }
  std::vector<T> messages() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.clear();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> messages_;
  std::optional<wire::Subscriber<T>> subscriber_;  ///< Last: it calls into the members above.
};

/// What a ROS 2 process that uses the server as a camera driver hears.
struct CameraListener {
  explicit CameraListener(const wire::Participant& p)
      : color(p, "color", wire::qos::reliable_input()),
        depth(p, "depth", wire::qos::reliable_input()),
        info(p, "color_info", wire::qos::reliable_input()) {}

  Listener<wire::sensor_msgs::Image> color, depth;
  Listener<wire::sensor_msgs::CameraInfo> info;
};

inline std::uint16_t depth_mm(const wire::sensor_msgs::Image& image, int u, int v) {
  std::uint16_t z = 0;
  std::memcpy(&z, image.data.data() + std::size_t{image.step} * static_cast<std::size_t>(v) + 2 * u,
              sizeof z);
  return z;
}

}  // namespace bpa::support
