// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/endpoint.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/service.hpp"
#include "tests/support/process_reading.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"
#include "tests/support/wall_view.hpp"

// A stranger sends spoiled samples into every input of a server, while a client asks. The number of
// samples is BPA_ATTACK_SAMPLES, 3000 otherwise; a thousand a second.

namespace bpa {
namespace {

namespace msgs = wire::bpa_msgs;
namespace rcl = wire::rcl_interfaces;
namespace sensor = wire::sensor_msgs;
using Bytes = std::vector<std::uint8_t>;
using SteadyClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenCalls{200};
constexpr double kMayGrow_mb = 50;
constexpr std::size_t kHeader = 4;  // of an encoding: DDS sends no less

int samples() {
  const char* text = std::getenv("BPA_ATTACK_SAMPLES");
  return text != nullptr ? std::atoi(text) : 3000;
}

/// Cut, lengthened, changed in some bytes, or with numbers that are too large for what follows.
Bytes spoiled(Bytes bytes, std::mt19937& random) {
  const auto below = [&](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  switch (below(4)) {
    case 0:
      bytes.resize(std::max(kHeader, below(bytes.size())));
      break;
    case 1:
      bytes.insert(bytes.end(), below(64), 0xff);
      break;
    case 2:
      for (int i = 0; i < 4; ++i) bytes[below(bytes.size())] = static_cast<std::uint8_t>(random());
      break;
    default:
      if (const std::size_t at = below(bytes.size()) & ~std::size_t{3}; at + 4 <= bytes.size()) {
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 4, std::uint8_t{0xff});
      }
  }
  return bytes;
}

/// One input of the server, and a legal sample for it.
struct Input {
  std::string topic;  ///< DDS's name.
  std::unique_ptr<wire::detail::RawWriter> writer;
  Bytes legal;
  bool request = false;
};

class Stranger {
 public:
  Stranger() : participant_(support::test_participant("stranger").value()) {
    topic("frames", support::wall_frame());
    topic("camera/color", support::wall_color_image(1));
    topic("camera/depth", support::wall_depth_image(1));
    topic("camera/info", support::wall_camera_info(1));
    wire::tf2_msgs::TFMessage transforms;
    transforms.transforms.resize(1);
    transforms.transforms[0].header.frame_id = "map";
    transforms.transforms[0].child_frame_id = "wall";
    transforms.transforms[0].transform.rotation.w = 1;
    topic("tf", transforms);
    service<msgs::RenameTrack>("rename_track", {"stub_1", "mine"});
    service<msgs::HoldTrack>("hold_track", {"stub_1", true});
    service<msgs::ForgetTrack>("forget_track", {"stub_1"});
    msgs::Detect_Request detect;
    detect.frame = support::wall_frame();
    service<msgs::Detect>("detect", detect);
    msgs::DetectViews_Request views;
    views.fixed_frame = "map";
    views.frames = {support::wall_frame()};
    views.scene_from_camera.resize(1);
    views.scene_from_camera[0].orientation.w = 1;
    service<msgs::DetectViews>("detect_views", views);
    service<msgs::ListModels>("list_models", {});
    service<msgs::GetStatus>("get_status", {});
    msgs::LoadModel_Request load;
    load.source = "nowhere";
    service<msgs::LoadModel>("load_model", load);
    msgs::UnloadModel_Request unload;
    unload.name = "nothing";
    service<msgs::UnloadModel>("unload_model", unload);
    rcl::SetParameters_Request set;
    set.parameters.resize(2);
    set.parameters[0].name = "no.such";
    service<rcl::SetParameters>("server/set_parameters", set);
    rcl::GetParameters_Request get;
    get.names = {"detection.continuous", "no.such"};
    service<rcl::GetParameters>("server/get_parameters", get);
    service<rcl::ListParameters>("server/list_parameters", {});
  }

  /// The first input that the server does not listen on; empty if it listens on all.
  std::string unmatched() const {
    for (const Input& input : inputs_) {
      if (!input.writer->matches().wait_for(1, milliseconds(5000))) return input.topic;
    }
    return "";
  }

  /// Sends to all inputs in turn. Returns how many samples DDS took.
  int attack(int count) {
    std::mt19937 random(1);
    const auto start = SteadyClock::now();
    int sent = 0;
    for (int i = 0; i < count; ++i) {
      const Input& input = inputs_[static_cast<std::size_t>(i) % inputs_.size()];
      const Bytes bytes = spoiled(input.legal, random);
      const wire::SampleId id{{1, 2, 3}, i};
      sent += input.writer
                  ->write(wire::detail::bytes_ref(bytes), input.request ? &id : nullptr, nullptr)
                  .ok();
      std::this_thread::sleep_until(start + milliseconds(i));
    }
    return sent;
  }

 private:
  void add(const wire::detail::EndpointSpec& spec, Bytes legal, bool request) {
    auto writer = wire::detail::make_writer(participant_, spec);
    ASSERT_TRUE(writer.ok()) << writer.status().message;
    inputs_.push_back({spec.dds_topic, std::move(writer).value(), std::move(legal), request});
  }
  template <class T>
  void topic(const std::string& name, const T& legal) {
    const auto resolved = participant_.resolve(name);
    ASSERT_TRUE(resolved.ok()) << resolved.status().message;
    add(wire::detail::endpoint_spec<T>(wire::dds_topic_name(*resolved), wire::qos::services()),
        wire::encode(legal), false);
  }
  template <class Service>
  void service(const std::string& name, const typename Service::Request& legal) {
    const auto spec =
        wire::detail::service_spec<Service>(participant_, name, wire::qos::services());
    ASSERT_TRUE(spec.ok()) << spec.status().message;
    add(spec->request, wire::encode(legal), true);
  }

  wire::Participant participant_;
  std::vector<Input> inputs_;
};

/// What a client sees that asks at 5 Hz.
struct Calls {
  int failed = 0;
  std::string failure;
  std::vector<double> milliseconds;

  double slowest() const { return std::ranges::max(milliseconds); }
};

Calls ask_until(Client& client, const std::function<bool()>& done) {
  Calls calls;
  const support::WallView wall;
  do {
    const auto start = SteadyClock::now();
    const auto found = client.detect_in(wall.view());
    calls.milliseconds.push_back(
        std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count());
    if (!found.ok()) {
      ++calls.failed;
      calls.failure = found.status().message;
    }
    std::this_thread::sleep_until(start + kBetweenCalls);
  } while (!done());
  return calls;
}

TEST(Attack, SpoiledSamplesKeepNobodyFromTheServer) {
  support::StubServer server({"input.color=camera/color", "input.depth=camera/depth",
                              "input.camera_info=camera/info", "tracking.fixed_frame=map"});
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message << server.log();
  ASSERT_TRUE(client->tracks([](const TrackSet&) {}).ok());
  Stranger stranger;
  ASSERT_EQ(stranger.unmatched(), "");
  const auto quiet_end = SteadyClock::now() + std::chrono::seconds(2);
  const Calls quiet = ask_until(*client, [&] { return SteadyClock::now() > quiet_end; });
  const double before_mb = support::read_process(server.process().pid()).memory_mb;
  std::atomic<int> sent{-1};
  std::thread attack([&] { sent = stranger.attack(samples()); });
  const Calls calls = ask_until(*client, [&] { return sent >= 0; });
  attack.join();
  const double grown_mb = support::read_process(server.process().pid()).memory_mb - before_mb;
  const auto status = client->status();
  ASSERT_TRUE(status.ok()) << status.status().message;
  const std::map<std::string, std::string> details(status->details.begin(), status->details.end());
  RecordProperty("quiet_slowest_ms", std::to_string(quiet.slowest()));
  RecordProperty("slowest_ms", std::to_string(calls.slowest()));
  std::cout << sent << " samples sent, " << calls.milliseconds.size() << " calls, slowest "
            << calls.slowest() << " ms (" << quiet.slowest() << " ms before), memory grew by "
            << grown_mb << " MB\n";
  EXPECT_EQ(quiet.failed, 0) << quiet.failure;
  EXPECT_EQ(calls.failed, 0) << calls.failure;
  EXPECT_LT(grown_mb, kMayGrow_mb);
  EXPECT_EQ(sent, samples());
  for (const char* input :
       {"requests malformed", "messages malformed of frames", "messages malformed of the camera"}) {
    EXPECT_GT(std::atoi(details.at(input).c_str()), 0) << input;
  }
}

}  // namespace
}  // namespace bpa
