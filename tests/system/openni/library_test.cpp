// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What OpenNI2's own programs make of our device and our recordings, and what we make of theirs.
#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "tests/system/openni/sim_sensor.hpp"

namespace bpa {
namespace {

using support::run;
using support::with_sensor;

class OpenniLibrary : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<support::Plate> plates = {{0, 0, 0.7, 0.08, {200, 0, 0}},
                                                {0.2, 0.1, 1.0, 0.09, {0, 200, 0}}};
    support::write_scenes(folder.path(), {support::plate_frame(plates, support::kSimCamera, 0)});
    support::set_sensor(folder.path());
    auto seat = support::test_participant("listener");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  /// What openni2_look prints; fails the test unless it exits 0.
  std::string look(const std::string& sensor, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), BPA_BINARY_DIR "/tests/openni2_look");
    const std::string log = folder / "look.log";
    EXPECT_EQ(run(with_sensor(sensor, arguments), log), 0) << test::slurp(log);
    return test::slurp(log);
  }
  std::string list_devices(const std::string& sensor) {
    const std::string log = folder / "list.log";
    EXPECT_EQ(run(with_sensor(sensor, {BPA_BINARY_DIR "/bin/bpa-server", "--list-devices"}), log),
              0);
    return test::slurp(log);
  }

  const test::TemporaryFolder folder;
  std::optional<wire::Participant> participant;
};

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(text.find(word), std::string::npos) << "no \"" << word << "\" in\n" << text;
  }
}

TEST_F(OpenniLibrary, OurDeviceIsADeviceToOpenNI2) {
  expect_words(look(folder.path(), {"bpa-sim", "5"}),
               {"device bpa-sim", "name Simulated Kinect", "depth mode 320x240@30 format 100",
                "depth mode 160x120@15 format 101", "color mode 320x240@30 format 200",
                "registration 1", "depth pixel 0 is 1600, middle 700", "read "});
}

TEST_F(OpenniLibrary, DevicesAreListedWithWhatIsWrong) {
  expect_words(list_devices(folder.path()),
               {"bpa-sim", "bpa Simulated Kinect", "depth: 320x240@30, 320x240@15, 160x120@30",
                "color: 320x240@30", "the device says that it can", "nothing is wrong with it"});
  support::set_sensor(folder.path(), "color_sensor: false\nregistration: none\n");
  expect_words(list_devices(folder.path()),
               {"bpa-sim", "! it has no color camera", "depth to colour: by the server"});
  support::set_sensor(folder.path());
  std::filesystem::remove_all(folder / "test");  // the device is there and cannot be opened
  expect_words(list_devices(folder.path()), {"bpa-sim", "! it cannot be opened", "/test"});
  EXPECT_EQ(list_devices("").find("bpa-sim"), std::string::npos);
}

TEST_F(OpenniLibrary, OurRecordingsPlayInOpenNI2AndTheirsInOurServer) {
  const std::string ours = folder / "ours.oni", theirs = folder / "theirs.oni";
  {
    support::SensorServer server(folder.path(), "openni2", {});
    ASSERT_TRUE(server.wait_for("images come from")) << server.log();
    auto client = Client::connect(support::client_options());
    ASSERT_TRUE(client.ok()) << client.status().message;
    ASSERT_TRUE(client->start_recording(ours, 0.5).ok());
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    ASSERT_TRUE(client->stop_recording().ok());
    EXPECT_EQ(server.stop(), 0);
  }
  expect_words(look("", {ours, "8"}),
               {"name oni File", "depth mode 320x240@30 format 100",
                "color mode 320x240@30 format 200", "depth pixel 0 is 1600, middle 700", "read "});
  look(folder.path(), {"bpa-sim", "20", theirs});
  support::SensorServer server("", theirs, {"capture.loop=true"});
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.depth.wait_for(3) && camera.color.wait_for(3)) << server.log();
  const auto depth = camera.depth.messages().back();
  EXPECT_EQ(support::depth_mm(depth, 0, 0), 1600);
  EXPECT_EQ(support::depth_mm(depth, 160, 120), 700);
  const auto color = camera.color.messages().back();
  EXPECT_EQ(color.data[3 * (120 * 320 + 160)], 200);
}

TEST_F(OpenniLibrary, DebiansDummyDeviceIsACameraOnceItIsCalibrated) {
  expect_words(look("", {"Dummy", "3"}),
               {"depth mode 320x240@30 format 100", "color mode 320x240@30 format 200",
                "depth pixel 0 is 2000"});
  // It does not say its field of view.
  {
    support::SensorServer server("", "openni2:Dummy", {"capture.color=false"});
    EXPECT_TRUE(
        server.wait_for("the device does not say the field of view of its depth camera; "
                        "give a calibration file"))
        << server.log();
  }
  test::spill(
      folder / "dummy.yaml",
      "image_width: 320\nimage_height: 240\ncamera_matrix: {rows: 3, cols: 3, data: [300, 0, "
      "160, 0, 301, 120, 0, 0, 1]}\n");
  const support::SensorServer server(
      "", "openni2:Dummy",
      {"capture.color=false", "capture.depth_calibration=" + (folder / "dummy.yaml")});
  support::CameraListener camera(*participant);
  ASSERT_TRUE(camera.depth.wait_for(3) && camera.info.wait_for(1)) << server.log();
  EXPECT_EQ(support::depth_mm(camera.depth.messages().back(), 17, 0), 2000);
  EXPECT_EQ(camera.info.messages().back().k[4], 301);
}

/// The colours on the screen of a virtual X server that writes its screen into a file.
std::set<std::uint32_t> colors_on_screen(const std::string& file) {
  const std::string bytes = support::read_text(file);
  std::set<std::uint32_t> colors;
  for (std::size_t i = 0x1000; i + 4 <= bytes.size(); i += 4) {
    std::uint32_t pixel = 0;
    std::memcpy(&pixel, bytes.data() + i, 4);
    colors.insert(pixel & 0xFFFFFFU);
  }
  return colors;
}

TEST_F(OpenniLibrary, NiViewerShowsOurDevice) {
  if (!std::filesystem::exists("/usr/bin/Xvfb") || !std::filesystem::exists("/usr/bin/NiViewer2")) {
    GTEST_SKIP() << "Xvfb or NiViewer2 is not installed";
  }
  const std::string display = ":" + std::to_string(100 + support::test_domain());
  const support::Process screen({"/usr/bin/Xvfb", display, "-screen", "0", "640x480x24", "-fbdir",
                                 folder.path(), "-nolisten", "tcp"});
  for (int i = 0; i < 500 && !std::filesystem::exists(folder / "Xvfb_screen0"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  support::Process viewer(
      with_sensor(folder.path(), {"/usr/bin/env", "DISPLAY=" + display, "LIBGL_ALWAYS_SOFTWARE=1",
                                  "/usr/bin/NiViewer2"}),
      folder / "viewer.log");
  // The red and the green plate, in colours that no window has.
  std::set<std::uint32_t> colors;
  const auto red = [](std::uint32_t c) { return (c >> 16) > 150 && (c & 0xFFFFU) < 0x3040U; };
  bool seen = false;
  for (int i = 0; i < 80 && !seen; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    colors = colors_on_screen(folder / "Xvfb_screen0");
    for (const std::uint32_t c : colors) seen = seen || red(c);
  }
  EXPECT_TRUE(seen) << colors.size() << " colours; " << test::slurp(folder / "viewer.log");
  EXPECT_EQ(viewer.wait(std::chrono::milliseconds(1)), -1) << "it ended by itself";
}

}  // namespace
}  // namespace bpa
