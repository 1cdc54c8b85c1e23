// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What goes wrong with sensors: each is said once, the server serves on, and what
// comes back is taken up again.
#include <gtest/gtest.h>

#include "tests/system/openni/sim_sensor.hpp"

namespace bpa {
namespace {

using support::SensorServer;
using support::set_sensor;
using wire::diagnostic_msgs::DiagnosticArray;
using wire::diagnostic_msgs::DiagnosticStatus;

class SensorFaults : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<support::Plate> plates = {{0, 0, 0.7, 0.08, {200, 0, 0}},
                                                {0.2, 0.1, 1.0, 0.09, {0, 200, 0}}};
    support::write_scenes(folder.path(), {support::plate_frame(plates, support::kSimCamera, 0)});
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  /// The server answers a service.
  void expect_serving() {
    const auto client = Client::connect(support::client_options());
    EXPECT_TRUE(client.ok()) << client.status().message;
  }
  /// What diagnostics say of the camera, once they say it at this level.
  std::string diagnosed(std::byte level) {
    support::Listener<DiagnosticArray> listener(*participant, "diagnostics", wire::qos::results());
    std::string message;
    (void)listener.wait_for([&](const DiagnosticArray& array) {
      for (const DiagnosticStatus& one : array.status) {
        const std::string end = ": capture";
        const bool ours = one.name.size() > end.size() &&
                          one.name.compare(one.name.size() - end.size(), end.size(), end) == 0;
        if (ours && one.level == level) message = one.message;
      }
      return !message.empty();
    });
    return message;
  }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
};

TEST_F(SensorFaults, AbsentAtTheStartPluggedInPulledOutPluggedInAgain) {
  set_sensor(folder.path(), "plugged: false\n");
  SensorServer server(folder.path(), "openni2", {});
  ASSERT_TRUE(server.wait_for("no OpenNI2 sensor is connected")) << server.log();
  EXPECT_EQ(diagnosed(DiagnosticStatus::kError), "no OpenNI2 sensor is connected");
  expect_serving();

  set_sensor(folder.path());
  ASSERT_TRUE(server.wait_for("images come from Simulated Kinect (bpa-sim)")) << server.log();
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.depth.wait_for(3)) << server.log();

  set_sensor(folder.path(), "plugged: false\n");
  ASSERT_TRUE(server.wait_for("Simulated Kinect (bpa-sim) was pulled out")) << server.log();
  EXPECT_EQ(diagnosed(DiagnosticStatus::kError), "Simulated Kinect (bpa-sim) was pulled out");
  expect_serving();
  camera.depth.clear();

  set_sensor(folder.path());
  ASSERT_TRUE(server.wait_for("images come from Simulated Kinect (bpa-sim)", 2)) << server.log();
  EXPECT_TRUE(camera.depth.wait_for(3)) << server.log();
  EXPECT_NE(diagnosed(DiagnosticStatus::kOk).find("images come"), std::string::npos);
  EXPECT_EQ(server.said("no OpenNI2 sensor is connected"), 1) << server.log();
  EXPECT_EQ(server.said("was pulled out"), 1) << server.log();
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(SensorFaults, ASensorThatIsNamedAndNotThere) {
  set_sensor(folder.path());
  SensorServer server(folder.path(), "openni2:1d27/0601@1/9", {});
  ASSERT_TRUE(server.wait_for("the OpenNI2 sensor 1d27/0601@1/9 is not there")) << server.log();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(server.said("is not there"), 1) << server.log();
  expect_serving();
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(SensorFaults, ADriverThatStopsDelivering) {
  set_sensor(folder.path());
  SensorServer server(folder.path(), "openni2", {});
  ASSERT_TRUE(server.wait_for("images come from")) << server.log();
  set_sensor(folder.path(), "deliver: false\n");
  ASSERT_TRUE(server.wait_for("delivers no frames any more")) << server.log();
  EXPECT_NE(diagnosed(DiagnosticStatus::kError).find("delivers no"), std::string::npos);
  expect_serving();
  set_sensor(folder.path());
  ASSERT_TRUE(server.wait_for("images come from", 2)) << server.log();
  EXPECT_EQ(server.said("delivers no frames any more"), 1) << server.log();
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(SensorFaults, ADriverThatHangsBlocksNothing) {
  set_sensor(folder.path());
  SensorServer server(folder.path(), "openni2", {});
  ASSERT_TRUE(server.wait_for("images come from")) << server.log();
  set_sensor(folder.path(), "wedged: true\n");
  ASSERT_TRUE(server.wait_for("the driver does not return from")) << server.log();
  expect_serving();
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok());
  EXPECT_EQ(client->start_recording(folder / "none.oni").status().code, StatusCode::unavailable);
  set_sensor(folder.path());
  ASSERT_TRUE(server.wait_for("images come from", 2)) << server.log();
  EXPECT_EQ(server.said("the driver does not return from"), 1) << server.log();
  // And one that hangs for ever does not keep the server from ending.
  set_sensor(folder.path(), "wedged: true\n");
  ASSERT_TRUE(server.wait_for("the driver does not return from", 2)) << server.log();
  EXPECT_EQ(server.stop(), 0) << server.log();
  EXPECT_EQ(server.said("left behind"), 1) << server.log();
}

TEST_F(SensorFaults, DepthWithoutColour) {
  set_sensor(folder.path());
  SensorServer server(folder.path(), "openni2", {});
  ASSERT_TRUE(server.wait_for("images come from")) << server.log();
  set_sensor(folder.path(), "deliver_color: false\n");
  ASSERT_TRUE(server.wait_for("depth comes without colour")) << server.log();
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.depth.wait_for(5)) << server.log();  // depth goes on
  EXPECT_NE(diagnosed(DiagnosticStatus::kWarn).find("without colour"), std::string::npos);
  set_sensor(folder.path());
  ASSERT_TRUE(camera.color.wait_for(3)) << server.log();
  EXPECT_EQ(server.said("depth comes without colour"), 1) << server.log();
  EXPECT_EQ(server.stop(), 0) << server.log();
}

TEST_F(SensorFaults, ASensorWithoutAColourCamera) {
  set_sensor(folder.path(), "color_sensor: false\n");
  SensorServer server(folder.path(), "openni2", {});
  ASSERT_TRUE(server.wait_for("it has no colour camera, so there is depth alone")) << server.log();
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.depth.wait_for(3)) << server.log();
  EXPECT_TRUE(camera.color.messages().empty());
}

TEST_F(SensorFaults, ModesAndCalibrationsThatDoNotFit) {
  set_sensor(folder.path());
  {
    const SensorServer server(folder.path(), "openni2", {"capture.color_mode=1280x1024@30"});
    ASSERT_TRUE(
        server.wait_for("capture.color_mode is 1280x1024@30; the device has 320x240@30, "
                        "320x240@15, 160x120@30"))
        << server.log();
  }
  test::spill(
      folder / "wide.yaml",
      "image_width: 640\nimage_height: 360\ncamera_matrix: {rows: 3, cols: 3, data: [500, 0, "
      "319, 0, 500, 179, 0, 0, 1]}\n");
  const SensorServer server(folder.path(), "openni2",
                            {"capture.calibration=" + (folder / "wide.yaml")});
  ASSERT_TRUE(server.wait_for("wide.yaml is for 640x360")) << server.log();
}

}  // namespace
}  // namespace bpa
