// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A bpa-server whose detector is a stand-in, for tests and for measuring everything but detection.
// It "finds" one object called "stub" as far away as the middle of the frame is deep.

#include <csignal>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>

#include "server/ros_arguments.hpp"
#include "server/server.hpp"
#include "server/supervision.hpp"
#include "tests/support/stub_recognition.hpp"

namespace {

using bpa::Status;

bpa::Models stub_models() {
  auto model = std::make_shared<bpa::ObjectModel>();
  model->name = "stub";
  model->number = 7;
  model->diameter = 0.2;
  model->surface.points = {{-0.1f, 0, 0}, {0.1f, 0.05f, 0.02f}};
  return {model};
}

bpa::Result<bpa::SceneInterpretations> detect(const bpa::Frame& frame,
                                              const bpa::DetectRequest& request, int delay_ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
  for (const std::string& name : request.models) {
    if (name != "stub") {
      return Status(bpa::StatusCode::not_found, "there is no model named \"" + name + "\"");
    }
  }
  const auto middle = static_cast<std::size_t>(frame.camera.height / 2 * frame.camera.width +
                                               frame.camera.width / 2);
  bpa::Placement placement;
  placement.model = "stub";
  placement.model_number = 7;
  placement.frame_from_object.translation.z() = static_cast<double>(frame.depth[middle]);
  placement.probability = placement.presence = 0.875;
  bpa::SceneInterpretations result;
  result.stamp_ns = frame.stamp_ns;
  result.frame_id = frame.frame_id;
  result.fused_frames = frame.fused;
  result.interpretations.push_back({1, 0.5, 1.0, {placement}});
  result.timings = {{"sleep", static_cast<double>(delay_ms)}};
  result.total_milliseconds = delay_ms;
  return result;
}

class Stub : public bpa::support::StubRecognition {
 public:
  explicit Stub(int delay_ms) : delay_ms_(delay_ms) {}
  bpa::Result<bpa::SceneInterpretations> detect(const bpa::Frame& frame,
                                                const bpa::DetectRequest& request) const override {
    return ::detect(frame, request, delay_ms_);
  }
  // The object of the first view, in the fixed frame; names of all cameras as warnings.
  bpa::Result<bpa::ViewsResult> detect_views(std::span<const bpa::View> views,
                                             const bpa::DetectRequest& request) const override {
    auto found = ::detect(views[0].frame, request, delay_ms_);
    if (!found.ok()) return found.status();
    bpa::ViewsResult out;
    out.scene = std::move(*found);
    bpa::Placement& placement = out.scene.interpretations[0].placements[0];
    placement = transformed(views[0].scene_from_camera, placement);
    for (const bpa::View& view : views) {
      out.scene_from_camera.push_back(view.scene_from_camera);
      out.warnings.push_back(view.frame.frame_id);
    }
    return out;
  }
  bpa::Models models() const override { return stub_models(); }
  Status set_options(const bpa::DetectorOptions& detector) override {
    std::cerr << "max_keypoints is " << detector.features.max_keypoints << std::endl;
    return {};
  }

 private:
  const int delay_ms_;
};

}  // namespace

int main(int argc, char** argv) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  CLI::App program("bpa-server without a detector");
  std::vector<std::string> settings;
  int delay_ms = 0;
  program.add_option("--set", settings, "group.key=value");
  program.add_option("--delay-ms", delay_ms, "how long a search takes");
  const auto ros = bpa::server::take_ros_arguments({argv, argv + argc});
  if (!ros.ok()) return std::cerr << ros.status().message << '\n', 2;
  std::vector<std::string> words(ros->own.rbegin(), ros->own.rend() - 1);
  try {
    program.parse(words);
  } catch (const CLI::ParseError& error) {
    return program.exit(error);
  }
  bpa::server::ServerOptions options;
  options.network.range = "localhost";
  for (const std::string& setting : settings) {
    const Status status = bpa::server::set_option(setting, options);
    if (!status.ok()) return std::cerr << status.message << '\n', 2;
  }
  if (Status s = bpa::server::apply(*ros, options); !s.ok()) {
    return std::cerr << s.message << '\n', 2;
  }
  const bpa::LogHook hook = [](bpa::LogLevel, std::string_view text) {
    std::cerr << text << std::endl;
  };
  auto server = bpa::server::Server::create(options, std::make_shared<Stub>(delay_ms), hook);
  if (!server.ok()) return std::cerr << server.status().message << '\n', 1;
  bpa::server::serve_until_signal(std::move(server).value(), signals, hook);
  return 0;
}
