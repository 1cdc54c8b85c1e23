// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

#include "core/io/image_file.hpp"
#include "tests/support/process.hpp"

// The examples as a newcomer runs them, built of an installed SDK (build_examples.cmake): the
// default namespace, the domain from the environment.

namespace bpa {
namespace {

using std::chrono::milliseconds;

/// The lines below "// Expected output" at the end of an example's source.
std::string expected_output(const std::string& name) {
  std::ifstream source(BPA_SOURCE_DIR "/client/examples/" + name + ".cpp");
  const std::string heading = "// Expected output", indent = "//   ";
  std::string output;
  bool below = false;
  for (std::string line; std::getline(source, line);) {
    if (below) {
      EXPECT_EQ(line.substr(0, indent.size()), indent) << name;
      output += line.substr(std::min(line.size(), indent.size())) + "\n";
    }
    below = below || line.substr(0, heading.size()) == heading;
  }
  EXPECT_FALSE(output.empty()) << name;
  return output;
}

class Examples : public testing::Test {
 protected:
  Examples() {
    setenv("ROS_DOMAIN_ID", std::to_string(support::test_domain()).c_str(), 1);
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
    unsetenv("ROS_LOCALHOST_ONLY");
    unsetenv("ROS_STATIC_PEERS");
  }
  static std::string program(const std::string& name) {
    return BPA_BINARY_DIR "/tests/examples/build/" + name;
  }
  std::string run(const std::string& name, const std::vector<std::string>& arguments = {},
                  int expected_code = 0) {
    const std::string log = support::scratch_folder() + "/" + name;
    std::vector<std::string> command = {program(name)};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const int code = support::run(command, log, milliseconds(20000));
    const std::string output = support::read_text(log);
    EXPECT_EQ(code, expected_code) << name << ": " << output;
    return output;
  }
};

TEST_F(Examples, PrintWhatTheySay) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server"},
                                support::scratch_folder() + "/server.log");
  for (const char* name : {"04_models", "03_stream"}) EXPECT_EQ(run(name), expected_output(name));
}

TEST_F(Examples, AFrameOfImageFilesIsSearched) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server"},
                                support::scratch_folder() + "/server.log");
  const std::string depth = support::scratch_folder() + "/depth.png";
  const std::string color = support::scratch_folder() + "/color.png";
  const std::size_t size = 640 * 480;
  ASSERT_TRUE(io::write_gray_png(depth, {640, 480, std::vector<std::uint16_t>(size, 800)}).ok());
  ASSERT_TRUE(io::write_color_png(color, {640, 480, std::vector<std::uint8_t>(3 * size, 99)}).ok());
  EXPECT_EQ(run("02_own_frame", {depth, color, "525", "525", "319.5", "239.5"}),
            expected_output("02_own_frame"));
  EXPECT_NE(run("02_own_frame", {color, color, "525", "525", "319.5", "239.5"}, 1).find("16-bit"),
            std::string::npos);
  EXPECT_NE(run("02_own_frame", {}, 1).find("usage"), std::string::npos);
}

TEST_F(Examples, DetectSearchesTheNextFrameOfTheStream) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server", "--delay-ms", "700"},
                                support::scratch_folder() + "/server.log");
  const std::string log = support::scratch_folder() + "/detect";
  support::Process detect({program("01_detect")}, log);
  run("03_stream");  // its frames are the server's camera
  EXPECT_EQ(detect.wait(milliseconds(10000)), 0) << support::read_text(log);
  EXPECT_EQ(support::read_text(log), expected_output("01_detect"));
}

TEST_F(Examples, TheCameraNodesFramesAreSearchedAndFollowed) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server"},
                                support::scratch_folder() + "/server.log");
  const std::string log = support::scratch_folder() + "/camera";
  const support::Process camera({program("05_camera")}, log);
  EXPECT_EQ(run("01_detect"), expected_output("01_detect"));
  EXPECT_EQ(run("06_tracks"), expected_output("06_tracks"));
  EXPECT_EQ(support::read_text(log), expected_output("05_camera"));
}

TEST_F(Examples, WithoutAServerSayWhatToDo) {
  EXPECT_NE(run("01_detect", {}, 1).find("is it running"), std::string::npos);
}

}  // namespace
}  // namespace bpa
