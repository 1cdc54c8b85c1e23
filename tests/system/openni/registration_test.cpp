// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Corner points in colour and depth, whoever registers: the device, the server for a device that
// only says so, and the server for one that cannot. The simulated depth camera has another focal
// length than the colour camera and stands 25 mm beside it; both its images are closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/system/openni/sim_sensor.hpp"

namespace bpa {
namespace {

using support::Plate;

constexpr Camera kInfrared{320, 240, 300, 300, 159.5, 119.5};

const std::vector<Plate> kPlates = {{-0.15, -0.09, 0.7, 0.06, {200, 0, 0}},
                                    {0.12, 0.08, 0.9, 0.08, {0, 200, 0}},
                                    {0.14, -0.12, 1.2, 0.09, {0, 0, 200}}};

/// Columns and rows that something covers.
struct Box {
  int left = 9999, right = -1, top = 9999, bottom = -1;
  int pixels = 0;

  void add(int u, int v) {
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
    ++pixels;
  }
};

Box in_color(const wire::sensor_msgs::Image& image, const Plate& plate) {
  Box box;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const std::uint8_t* rgb = image.data.data() + static_cast<std::size_t>(v) * image.step +
                                3 * static_cast<std::size_t>(u);
      if (std::equal(plate.color.begin(), plate.color.end(), rgb)) box.add(u, v);
    }
  }
  return box;
}

Box in_depth(const wire::sensor_msgs::Image& image, const Plate& plate) {
  Box box;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      if (std::abs(support::depth_mm(image, u, v) - 1000 * plate.z) < 5) box.add(u, v);
    }
  }
  return box;
}

class Registration : public ::testing::Test {
 protected:
  void SetUp() override {
    support::write_scenes(folder.path(), {support::plate_frame(kPlates, support::kSimCamera, 0)});
    support::write_infrared(folder.path(), support::plate_frame(kPlates, kInfrared, -0.025), 0);
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }

  /// Colour and depth of one moment.
  void expect_corners_to_meet(const std::string& source, const std::vector<std::string>& settings,
                              double tolerance = 1) {
    support::SensorServer server(folder.path(), source, settings);
    support::CameraListener camera(*participant);
    ASSERT_TRUE(camera.color.wait_for(3) && camera.depth.wait_for(3)) << server.log();
    const wire::sensor_msgs::Image color = camera.color.messages().back(),
                                   depth = camera.depth.messages().back();
    for (const Plate& plate : kPlates) {
      const Box c = in_color(color, plate), d = in_depth(depth, plate);
      ASSERT_GT(c.pixels, 500);
      // Where it truly is, so not mirrored, as the sensor delivers it at first.
      const Eigen::Vector2d corner =
          support::kSimCamera.project({plate.x - plate.half, plate.y - plate.half, plate.z});
      EXPECT_NEAR(c.left, corner.x(), 1);
      EXPECT_NEAR(c.top, corner.y(), 1);
      ASSERT_GT(d.pixels, 500) << server.log();
      EXPECT_NEAR(c.left, d.left, tolerance) << plate.z;
      EXPECT_NEAR(c.right, d.right, tolerance) << plate.z;
      EXPECT_NEAR(c.top, d.top, tolerance) << plate.z;
      EXPECT_NEAR(c.bottom, d.bottom, tolerance) << plate.z;
      EXPECT_EQ(d.pixels, (d.right - d.left + 1) * (d.bottom - d.top + 1)) << plate.z;  // no holes
    }
    last_log = server.log();
    EXPECT_EQ(server.stop(), 0);
  }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
  std::string last_log;
};

TEST_F(Registration, ByADeviceThatDoesIt) {
  support::set_sensor(folder.path());
  expect_corners_to_meet("openni2", {}, 0);
  EXPECT_EQ(last_log.find("the server does it"), std::string::npos) << last_log;
}

TEST_F(Registration, ADeviceThatOnlySaysSoIsFoundOut) {
  support::set_sensor(folder.path(), "registration: pretended\n");
  expect_corners_to_meet("openni2", {});
  EXPECT_NE(last_log.find("the server does it"), std::string::npos) << last_log;
}

TEST_F(Registration, ByTheServerForADeviceThatCannot) {
  support::set_sensor(folder.path(), "registration: none\n");
  expect_corners_to_meet("openni2", {});
  EXPECT_NE(last_log.find("the server does it"), std::string::npos) << last_log;
}

TEST_F(Registration, ADeviceThatMustDoItAndDoesNotIsRefused) {
  support::set_sensor(folder.path(), "registration: pretended\n");
  const support::SensorServer server(folder.path(), "openni2", {"capture.registration=device"});
  EXPECT_TRUE(server.wait_for("does not register depth to colour; set capture.registration"))
      << server.log();
}

TEST_F(Registration, UnregisteredDepthIsOffByManyPixels) {
  // That the corners above meet is worth something: without registration they do not.
  support::set_sensor(folder.path(), "registration: none\n");
  support::SensorServer server(folder.path(), "openni2", {"capture.registration=off"});
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.color.wait_for(3) && camera.depth.wait_for(3)) << server.log();
  const Box c = in_color(camera.color.messages().back(), kPlates[0]);
  const Box d = in_depth(camera.depth.messages().back(), kPlates[0]);
  EXPECT_GT(std::abs(c.left - d.left), 3);
}

TEST_F(Registration, OfARecordingThatWasMadeWithoutIt) {
  support::set_sensor(folder.path(), "registration: none\n");
  const std::string file = folder / "raw.oni";
  {
    support::SensorServer server(folder.path(), "openni2", {});
    ASSERT_TRUE(server.wait_for("images come from")) << server.log();
    ASSERT_EQ(support::run(
                  support::own_command("bpa-client", {"record", "--oni", file, "--seconds", "0.5"}),
                  folder / "record.log"),
              0)
        << test::slurp(folder / "record.log");
    EXPECT_EQ(server.stop(), 0);
  }
  expect_corners_to_meet(file, {"capture.loop=true"});
}

TEST_F(Registration, ACalibrationFileGoesOutWithTheImages) {
  support::set_sensor(folder.path());
  test::spill(
      folder / "rgb.yaml",
      "image_width: 640\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [580, 0, "
      "315.5, 0, 582, 241.5, 0, 0, 1]}\ndistortion_model: plumb_bob\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [0.1, -0.2, 0.001, 0.002, 0.05]}\n");
  const support::SensorServer server(folder.path(), "openni2",
                                     {"capture.calibration=" + (folder / "rgb.yaml")});
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.info.wait_for(1)) << server.log();
  const auto info = camera.info.messages().back();
  EXPECT_EQ(info.d, (std::vector<double>{0.1, -0.2, 0.001, 0.002, 0.05}));
  // For images of half the size; pixel (0, 0) is the middle of its pixel.
  EXPECT_DOUBLE_EQ(info.k[0], 290);
  EXPECT_DOUBLE_EQ(info.k[4], 291);
  EXPECT_DOUBLE_EQ(info.k[2], 157.5);
  EXPECT_DOUBLE_EQ(info.k[5], 120.5);
}

TEST_F(Registration, OfDepthInTenthsOfMillimetres) {
  support::set_sensor(folder.path(), "registration: none\nfine_depth: true\n");
  support::SensorServer server(folder.path(), "openni2", {});
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.color.wait_for(3) && camera.depth.wait_for(3)) << server.log();
  const wire::sensor_msgs::Image depth = camera.depth.messages().back();
  const Box c = in_color(camera.color.messages().back(), kPlates[0]);
  ASSERT_EQ(depth.encoding, "32FC1");
  float metres = 0;
  const int pixel = (c.top + c.bottom) / 2 * 320 + (c.left + c.right) / 2;
  std::memcpy(&metres, depth.data.data() + 4 * pixel, sizeof metres);
  EXPECT_FLOAT_EQ(metres, 0.7f);
}

}  // namespace
}  // namespace bpa
