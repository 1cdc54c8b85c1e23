// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A live sensor at 30 Hz while its frames are searched, its topics in another process (this one), a
// recording of it, and the recording played back: the same images give the same detections.
#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/system/openni/sim_sensor.hpp"

namespace bpa {
namespace {

using wire::bpa_msgs::SceneInterpretations;

/// An L and a brick on a table, with the noise of a Kinect, seen from another side each time.
Frame table_frame(int index) {
  const double turn = 0.4 * index;
  const Pose camera_from_world =
      test::look_at({0.6 * std::sin(turn), -0.6 * std::cos(turn), 0.5}, {0, 0, 0});
  const auto solids = test::together(
      test::together({test::table(camera_from_world)},
                     test::l_solids(camera_from_world * test::standing_at(-0.08, 0, 0.02, 0.7))),
      {test::brick_solid(camera_from_world * test::standing_at(0.12, 0.02, 0.025, -0.4))});
  Frame frame = test::render(solids, test::kinect_camera(320), 1, 8).frame;
  for (std::size_t i = 0; i < 3 * frame.depth.size(); ++i) {
    frame.color.push_back(static_cast<std::uint8_t>(i * static_cast<std::size_t>(index + 3) % 251));
  }
  return frame;
}

/// What was found, without what may differ: stamps and times.
std::string found_in(SceneInterpretations message) {
  message.header = {};
  message.stage_timings.clear();
  message.total_ms = 0;
  std::vector<std::uint8_t> bytes(wire::encoded_size(message));
  wire::encode(message, bytes.data(), bytes.size());
  return {bytes.begin(), bytes.end()};
}

/// Pixels of a set of images and what was found in it, by stamp.
struct Session {
  std::map<std::int64_t, std::string> depth, color, found;

  template <class T>
  static void keep(std::map<std::int64_t, std::string>& place, const std::vector<T>& messages) {
    for (const T& m : messages) place[to_ns(m.header.stamp)] = {m.data.begin(), m.data.end()};
  }
  Session(support::CameraListener& camera, support::Listener<SceneInterpretations>& results) {
    keep(depth, camera.depth.messages());
    keep(color, camera.color.messages());
    for (const SceneInterpretations& m : results.messages()) {
      found[to_ns(m.header.stamp)] = found_in(m);
    }
  }
  /// What was found, by the pixels that it was found in.
  std::map<std::string, std::string> by_image() const {
    std::map<std::string, std::string> pairs;
    for (const auto& [stamp, result] : found) {
      const auto d = depth.find(stamp);
      const auto c = color.find(stamp);
      if (d != depth.end() && c != color.end()) pairs[d->second + c->second] = result;
    }
    return pairs;
  }
};

class LiveSensor : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<Frame> scenes;
    for (int i = 0; i < 4; ++i) scenes.push_back(table_frame(i));
    support::write_scenes(folder.path(), scenes);
    support::set_sensor(folder.path());
    for (const auto& [mesh, name, number] :
         {std::tuple(test::l_mesh(), "l", 1),
          std::tuple(test::box_mesh(test::kBrickHalf), "brick", 2)}) {
      const auto model = modeling::model_source_from_mesh(mesh, name, number);
      ASSERT_TRUE(model.ok()) << model.status().message;
      ASSERT_TRUE(io::save_model(library(), *model).ok());
    }
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  std::string library() const { return folder / "library"; }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
};

TEST_F(LiveSensor, StreamsAt30HzIsRecordedAndPlaysBackToTheSameDetections) {
  // What is found in a frame must not depend on which frames were searched before.
  const std::vector<std::string> settings = {
      "detection.seed=7",        "detection.threads=1",
      "detection.follow=false",  "detector.max_references=200",
      "detector.max_refined=10", "detector.annealing_steps=3000"};
  const std::string file = folder / "live.oni";
  std::optional<Session> live;
  {
    support::SensorServer server(folder.path(), "openni2", settings, library());
    support::CameraListener camera(*participant);
    support::Listener<SceneInterpretations> results(*participant, "interpretations",
                                                    wire::qos::results());
    ASSERT_TRUE(results.wait_for(1, 20000)) << server.log();  // it detects
    const std::size_t before = camera.depth.messages().size();
    ASSERT_EQ(support::run(
                  support::own_command("bpa-client", {"record", "--oni", file, "--seconds", "3"}),
                  folder / "record.log"),
              0)
        << test::slurp(folder / "record.log") << server.log();
    EXPECT_TRUE(results.wait_for(3, 20000)) << server.log();
    live.emplace(camera, results);
    // 30 Hz while it detected: stamps lie 33.3 ms apart, and hardly one is missing.
    std::vector<std::int64_t> stamps;
    for (const auto& [stamp, pixels] : live->depth) stamps.push_back(stamp);
    ASSERT_GT(stamps.size(), before + 60);
    int regular = 0;
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      const double gap_ms = 1e-6 * static_cast<double>(stamps[i] - stamps[i - 1]);
      if (gap_ms > 31 && gap_ms < 36) ++regular;
    }
    EXPECT_GT(regular, 0.9 * static_cast<double>(stamps.size()));
    // And they are the host's time, though the device counts from its own start.
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    EXPECT_LT(stamps.back(), now_ns);
    EXPECT_GT(stamps.back(), now_ns - 10'000'000'000);
    const wire::sensor_msgs::CameraInfo info = camera.info.messages().back();
    EXPECT_EQ(info.width, 320U);
    EXPECT_NEAR(info.k[0], 262.5, 1e-3);
    EXPECT_NEAR(info.k[2], 159.5, 1e-9);
    EXPECT_EQ(server.stop(), 0) << server.log();
  }
  std::vector<std::string> repeated = settings;
  repeated.push_back("capture.loop=true");
  support::SensorServer server("", file, repeated, library());
  support::CameraListener camera(*participant);
  support::Listener<SceneInterpretations> results(*participant, "interpretations",
                                                  wire::qos::results());
  // Until two views that were searched live have been searched again.
  const std::map<std::string, std::string> before = live->by_image();
  std::optional<Session> played;
  int compared = 0;
  for (std::size_t count = 2; count < 40 && compared < 2; ++count) {
    ASSERT_TRUE(results.wait_for(count, 20000)) << server.log();
    played.emplace(camera, results);
    compared = 0;
    for (const auto& [pixels, found] : played->by_image()) {
      compared += static_cast<int>(before.count(pixels));
    }
  }
  ASSERT_GE(compared, 2) << before.size();
  // The images are those of the live run, to the last bit ...
  const auto one_of = [](const std::string& pixels,
                         const std::map<std::int64_t, std::string>& set) {
    return std::any_of(set.begin(), set.end(), [&](const auto& e) { return e.second == pixels; });
  };
  ASSERT_GT(played->depth.size(), 5U);
  for (const auto& [stamp, pixels] : played->depth) ASSERT_TRUE(one_of(pixels, live->depth));
  for (const auto& [stamp, pixels] : played->color) ASSERT_TRUE(one_of(pixels, live->color));
  // ... and so is what is found in them.
  for (const auto& [pixels, found] : played->by_image()) {
    const auto same = before.find(pixels);
    if (same == before.end()) continue;
    EXPECT_TRUE(same->second == found);
  }
  int objects = 0;
  for (const SceneInterpretations& m : results.messages()) {
    ASSERT_EQ(m.status.code, 0) << m.status.message;
    objects +=
        m.interpretations.empty() ? 0 : static_cast<int>(m.interpretations[0].placements.size());
  }
  EXPECT_GT(objects, 0);  // so that there was something to be equal
}

}  // namespace
}  // namespace bpa
