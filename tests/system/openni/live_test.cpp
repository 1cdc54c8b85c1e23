// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A live sensor at 30 Hz while its frames are searched, its topics in another process (this one), a
// recording of it, and the recording played back: the same images give the same detections.
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include <bpa/core/io/mesh_file.hpp>
#include <bpa/core/io/model_file.hpp>
#include <bpa/wire/cdr.hpp>
#include <bpa/wire/msg/builtin_interfaces.hpp>

#include "sim_sensor.hpp"

namespace bpa {
namespace {

using wire::bpa_msgs::SceneInterpretations;
using wire::sensor_msgs::Image;

/// A box of 2 x half side lengths and its middle.
void add_box(TriangleMesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                               (i & 4) != 0 ? high.z() : low.z());
  }
  const std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
    mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
  }
}

/// The box with a smaller one on it, seen straight on at (x, y) before a wall.
Frame step_frame(double x, double y) {
  Frame frame = support::plate_frame({}, support::kSimCamera, 0);
  for (int v = 0; v < frame.camera.height; ++v) {
    for (int u = 0; u < frame.camera.width; ++u) {
      const auto inside = [&](double z, double x0, double x1, double y0, double y1) {
        const Eigen::Vector3d p = frame.camera.unproject(u, v, z);
        return p.x() - x >= x0 && p.x() - x <= x1 && p.y() - y >= y0 && p.y() - y <= y1;
      };
      float& z = frame.depth[static_cast<std::size_t>(v * frame.camera.width + u)];
      z = 0.7f;
      if (inside(0.66, -0.03, 0.03, -0.045, 0.045)) z = 0.66f;
      if (inside(0.63, -0.03, 0.0, 0.0, 0.045)) z = 0.63f;
    }
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
    for (int i = 0; i < 4; ++i) {
      scenes.push_back(step_frame(0.03 * i - 0.05, 0.02 * i - 0.03));
      for (std::size_t p = 0; p < scenes.back().color.size(); ++p) {
        scenes.back().color[p] =
            static_cast<std::uint8_t>(p * static_cast<std::size_t>(i + 3) % 251);
      }
    }
    support::write_scenes(folder.path(), scenes);
    support::set_sensor(folder.path());
    TriangleMesh mesh;
    add_box(mesh, {-0.03f, -0.045f, -0.02f}, {0.03f, 0.045f, 0.02f});
    add_box(mesh, {-0.03f, -0.045f, 0.02f}, {0.0f, 0.0f, 0.05f});
    const auto model = model_source_from_mesh(mesh, "step", 4);
    ASSERT_TRUE(model.ok()) << model.status().message;
    ASSERT_TRUE(io::save_model(library(), *model).ok());
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  std::string library() const { return folder / "library"; }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
};

TEST_F(LiveSensor, StreamsAt30HzIsRecordedAndPlaysBackToTheSameDetections) {
  const std::vector<std::string> settings = {"detection.seed=7", "detection.threads=1"};
  const std::string file = folder / "live.oni";
  std::optional<Session> live;
  {
    support::SensorServer server(folder.path(), "openni2", settings, library());
    support::CameraListener camera(*participant);
    support::Listener<SceneInterpretations> results(*participant, "interpretations",
                                                    wire::qos::results());
    ASSERT_TRUE(results.wait_for(1, 20000)) << server.log();  // it detects
    const std::size_t before = camera.depth.messages().size();
    ASSERT_EQ(support::run({BPA_BINARY_DIR "/bin/bpa-client", "--localhost", "--domain",
                            std::to_string(support::test_domain()), "--namespace",
                            support::test_namespace(), "record", "--oni", file, "--seconds", "3"},
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
    const wire::sensor_msgs::CameraInfo info = camera.info.messages().back();
    EXPECT_EQ(info.width, 320U);
    EXPECT_NEAR(info.k[0], 285, 1e-3);
    EXPECT_NEAR(info.k[2], 159.5, 1e-9);
    EXPECT_EQ(server.stop(), 0) << server.log();
  }
  support::SensorServer server("", file, settings, library());
  ASSERT_TRUE(server.wait_for("images come from the recording")) << server.log();
  support::CameraListener camera(*participant);
  support::Listener<SceneInterpretations> results(*participant, "interpretations",
                                                  wire::qos::results());
  ASSERT_TRUE(server.wait_for("has come to its end")) << server.log();
  ASSERT_TRUE(results.wait_for(3, 20000)) << server.log();
  const Session played(camera, results);
  // The images are those of the live run, to the last bit ...
  const auto one_of = [](const std::string& pixels,
                         const std::map<std::int64_t, std::string>& set) {
    return std::any_of(set.begin(), set.end(), [&](const auto& e) { return e.second == pixels; });
  };
  ASSERT_GT(played.depth.size(), 30U);
  for (const auto& [stamp, pixels] : played.depth) ASSERT_TRUE(one_of(pixels, live->depth));
  for (const auto& [stamp, pixels] : played.color) ASSERT_TRUE(one_of(pixels, live->color));
  // ... and so is what is found in them.
  const auto before = live->by_image(), after = played.by_image();
  int compared = 0;
  for (const auto& [pixels, found] : after) {
    const auto same = before.find(pixels);
    if (same == before.end()) continue;
    EXPECT_TRUE(same->second == found);
    ++compared;
  }
  EXPECT_GE(compared, 2) << before.size() << " and " << after.size();
  int objects = 0;
  for (const SceneInterpretations& m : results.messages()) {
    ASSERT_EQ(m.status.code, 0) << m.status.message;
    objects +=
        m.interpretations.empty() ? 0 : static_cast<int>(m.interpretations[0].placements.size());
  }
  EXPECT_GT(objects, 0);  // so that there was something to be equal
}

TEST_F(LiveSensor, PlaybackRepeatsStartsWhereItIsToldAndShowsEveryFrame) {
  const std::string file = folder / "short.oni";
  int frames = 0;
  {
    support::SensorServer server(folder.path(), "openni2", {});
    ASSERT_TRUE(server.wait_for("images come from")) << server.log();
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message;
    ASSERT_TRUE(client->start_recording(file, 0.6).ok());
    std::this_thread::sleep_for(std::chrono::milliseconds(800));
    const auto recording = client->stop_recording();  // it ended by itself
    ASSERT_TRUE(recording.ok()) << recording.status().message;
    frames = recording->frames;
    ASSERT_GT(frames, 10);
  }
  const auto shown = [&](const std::vector<std::string>& settings, std::size_t enough) {
    support::SensorServer server("", file, settings);
    const bool plays = server.wait_for("images come from the recording");
    EXPECT_TRUE(plays) << server.log();
    auto client = Client::connect(support::client_options());
    if (!plays || !client.ok()) return std::size_t{0};
    std::size_t sets = 0;
    for (int i = 0; i < 400 && sets < enough && server.said("come to its end") == 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const auto status = client->status();
      if (!status.ok()) break;
      for (const auto& [key, value] : status->details) {
        if (key == "capture: sets of images") sets = std::stoul(value);
      }
    }
    const auto status = client->status();  // once more after the end
    for (const auto& [key, value] : status->details) {
      if (key == "capture: sets of images") sets = std::stoul(value);
    }
    return sets;
  };
  const auto count = static_cast<std::size_t>(frames);
  constexpr std::size_t kAll = 1000;
  EXPECT_EQ(shown({"capture.every_frame=true"}, kAll), count);
  EXPECT_EQ(shown({"capture.every_frame=true", "capture.start_frame=8"}, kAll), count - 7);
  EXPECT_GT(shown({"capture.loop=true", "capture.speed=4"}, 3 * count), 2 * count);
  support::SensorServer beyond("", file, {"capture.start_frame=9000"});
  EXPECT_TRUE(beyond.wait_for("capture.start_frame is 9000; ")) << beyond.log();
}

TEST_F(LiveSensor, ADataSetIsACameraToo) {
  support::SensorServer server("", "bop:" + folder.path(), {"capture.loop=true"});
  support::CameraListener camera(*participant);
  support::Listener<wire::sensor_msgs::PointCloud2> points(*participant, "points",
                                                           wire::qos::reliable_input());
  ASSERT_TRUE(camera.depth.wait_for(6) && camera.color.wait_for(6) && points.wait_for(1))
      << server.log();
  EXPECT_EQ(camera.depth.messages().front().encoding, "32FC1");
  const auto cloud = points.messages().front();
  EXPECT_EQ(cloud.width, 320U);
  EXPECT_EQ(cloud.height, 240U);
  EXPECT_EQ(cloud.header.frame_id, "camera_color_optical_frame");
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(LiveSensor, ExposureIsASetting) {
  const auto brightness = [&](const std::vector<std::string>& settings) {
    support::SensorServer server(folder.path(), "openni2", settings);
    support::CameraListener camera(*participant);
    if (!camera.color.wait_for(2)) return -1.0;
    const Image image = camera.color.messages().back();
    double sum = 0;
    for (const std::uint8_t value : image.data) sum += value;
    return sum / static_cast<double>(image.data.size());
  };
  const double usual = brightness({});
  const double dark = brightness({"capture.auto_exposure=false", "capture.exposure=50"});
  EXPECT_GT(usual, 100);
  EXPECT_NEAR(dark, usual / 2, 2);
}

}  // namespace
}  // namespace bpa
