// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/http_client.hpp"
#include "tests/support/process.hpp"
#include "tests/system/openni/sim_sensor.hpp"

namespace bpa::support {

/// Simulated frames of a mug, a can and a box, and the library of their models: made once.
struct SimulatedFrames {
  const std::string frames = scratch_folder() + "/frames";
  const std::string library = scratch_folder() + "/library";
  const std::string log = scratch_folder() + "/simulate.log";
  bool made = false;

  static const SimulatedFrames& get() {
    static const SimulatedFrames simulated;
    return simulated;
  }

 private:
  SimulatedFrames() {
    const std::string bpa = BPA_BINARY_DIR "/bin/bpa";
    made = run({bpa, "simulate", "scenes", "--out", frames, "--scenes", "2", "--seed", "6",
                "--objects", "3,4", "--clutter", "0,0", "--models", "mug,can,cereal_box,banana"},
               log, std::chrono::seconds(120)) == 0 &&
           run({bpa, "model", "from-bop", frames, "--library", library}, log,
               std::chrono::seconds(120)) == 0;
  }
};

/// The folder of a simulated OpenNI2 sensor that shows the first simulated frame at 30 Hz.
inline std::string sensor_of_one_frame() {
  namespace fs = std::filesystem;
  const std::string folder = scratch_folder() + "/sensor";
  fs::remove_all(folder);
  fs::copy(SimulatedFrames::get().frames, folder, fs::copy_options::recursive);
  fs::remove_all(folder + "/test/000002");
  set_sensor(folder);
  return folder;
}

/// bpa-server with a page, in this test's domain and namespace. Its camera is the simulated frames
/// over and over, or the simulated sensor of a folder.
class PageServer {
 public:
  explicit PageServer(const std::string& listen = "0", const std::vector<std::string>& more = {},
                      const std::string& sensor = "")
      : log_path_(scratch_folder() + "/page_server.log") {
    const SimulatedFrames& simulated = SimulatedFrames::get();
    command_ = own_command("bpa-server", {"--library", simulated.library});
    if (sensor.empty()) {
      command_.insert(command_.end(), {"--capture", "bop:" + simulated.frames, "--set",
                                       "capture.loop=true", "--set", "capture.speed=0.2"});
    } else {
      command_.insert(command_.end(), {"--capture", "openni2"});
    }
    command_.insert(command_.end(), more.begin(), more.end());
    if (!sensor.empty()) command_ = with_sensor(sensor, command_);
    start(listen);
  }

  /// Starts it again, once it was stopped.
  void start(const std::string& listen) {
    std::vector<std::string> command = command_;
    command.insert(command.end(), {"--web", listen});
    process_ = std::make_unique<Process>(command, log_path_);
    const std::regex line(R"(page: (http://[^ ]*:(\d+)/\S*))");
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    std::smatch found;
    for (std::string log; std::chrono::steady_clock::now() < end;) {
      log = read_text(log_path_);
      if (std::regex_search(log, found, line)) {
        address_ = found[1];
        port_ = std::stoi(found[2]);
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void stop() { process_.reset(); }

  int port() const { return port_; }
  const std::string& address() const { return address_; }
  pid_t pid() const { return process_->pid(); }
  std::string log() const { return read_text(log_path_); }

  /// JSON of a path; null where the answer is another.
  nlohmann::json get(const std::string& path) const {
    const HttpAnswer answer = http(port_, "GET", path);
    return answer.status == 200 ? nlohmann::json::parse(answer.body, nullptr, false) : nullptr;
  }
  HttpAnswer post(const std::string& path, const std::string& body) const {
    return http(port_, "POST", path, body);
  }

 private:
  std::string log_path_, address_;
  std::vector<std::string> command_;
  std::unique_ptr<Process> process_;
  int port_ = 0;
};

}  // namespace bpa::support
