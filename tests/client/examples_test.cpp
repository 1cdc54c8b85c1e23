// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>

#include "tests/support/process.hpp"

// The examples as a newcomer runs them: the default namespace, the domain from the environment.

namespace bpa {
namespace {

using std::chrono::milliseconds;

class Examples : public testing::Test {
 protected:
  Examples() {
    setenv("ROS_DOMAIN_ID", std::to_string(support::test_domain()).c_str(), 1);
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
    unsetenv("ROS_LOCALHOST_ONLY");
    unsetenv("ROS_STATIC_PEERS");
  }
  std::string run(const std::string& name, int expected_code = 0) {
    const std::string log = support::scratch_folder() + "/" + name;
    const int code = support::run({std::string(BPA_BINARY_DIR "/examples/example_") + name}, log,
                                  milliseconds(20000));
    const std::string output = support::read_text(log);
    EXPECT_EQ(code, expected_code) << name << ": " << output;
    return output;
  }
};

TEST_F(Examples, PrintWhatTheySay) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server"},
                                support::scratch_folder() + "/server.log");
  EXPECT_EQ(run("04_models"), "stub, 200 mm across\n0 frames searched, 0 dropped\n");
  EXPECT_EQ(run("02_own_frame"), "1 objects in 0 ms\n");
  EXPECT_EQ(run("03_stream"), "frame 1: 1 objects\nframe 2: 1 objects\nframe 3: 1 objects\n");
}

TEST_F(Examples, DetectSearchesTheNextFrameOfTheStream) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server", "--delay-ms", "700"},
                                support::scratch_folder() + "/server.log");
  const std::string log = support::scratch_folder() + "/detect";
  support::Process detect({BPA_BINARY_DIR "/examples/example_01_detect"}, log);
  run("03_stream");  // its frames are the server's camera
  EXPECT_EQ(detect.wait(milliseconds(10000)), 0) << support::read_text(log);
  EXPECT_EQ(support::read_text(log), "stub: 87.5 % at 0 0 0.8 m\n");
}

TEST_F(Examples, TheCameraNodesFramesAreSearched) {
  const support::Process server({BPA_BINARY_DIR "/tests/bpa-stub-server"},
                                support::scratch_folder() + "/server.log");
  const std::string log = support::scratch_folder() + "/camera";
  const support::Process camera({BPA_BINARY_DIR "/examples/example_05_camera"}, log);
  EXPECT_EQ(run("01_detect"), "stub: 87.5 % at 0 0 0.8 m\n");
  EXPECT_EQ(support::read_text(log), "publishing on /camera/color/image_raw\n");
}

TEST_F(Examples, WithoutAServerSayWhatToDo) {
  EXPECT_NE(run("01_detect", 1).find("is it running"), std::string::npos);
}

}  // namespace
}  // namespace bpa
