// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_poses_file.hpp"

#include <gtest/gtest.h>

#include "core/io/file_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

class CameraPosesFile : public ::testing::Test {
 protected:
  std::string path() const { return folder_.path() + "/cameras.json"; }
  Status read(const std::string& text) {
    EXPECT_TRUE(write_file(path(), text).ok());
    return read_camera_poses(path()).status();
  }
  test::TemporaryFolder folder_;
};

TEST_F(CameraPosesFile, KeepsNamesAndNumbers) {
  const Pose pose{rotation_from_vector({0.1, -0.7, 1.0 / 3}), {0.1, 2.0 / 3, -5}};
  ASSERT_TRUE(write_camera_poses(path(), {{"left", pose}, {"", Pose{}}}).ok());
  const auto cameras = read_camera_poses(path());
  ASSERT_TRUE(cameras.ok()) << cameras.status().message;
  ASSERT_EQ(cameras->size(), 2u);
  EXPECT_EQ((*cameras)[0].name, "left");
  EXPECT_EQ((*cameras)[0].scene_from_camera.translation, pose.translation);
  EXPECT_EQ((*cameras)[0].scene_from_camera.rotation.coeffs(), pose.rotation.coeffs());
}

TEST_F(CameraPosesFile, SaysWhatIsWrong) {
  EXPECT_EQ(read("{").code, StatusCode::corrupt);
  EXPECT_EQ(read(R"({"cameras": [{"name": "left"}]})").code, StatusCode::corrupt);
  const Status turned = read(R"({"cameras": [{"scene_from_camera":
      {"rotation_wxyz": [2, 0, 0, 0], "translation_m": [0, 0, 0]}}]})");
  EXPECT_EQ(turned.code, StatusCode::invalid_argument);
  EXPECT_NE(turned.message.find("cameras[0].scene_from_camera is no rigid motion"),
            std::string::npos);
  EXPECT_EQ(read_camera_poses(path() + "x").status().code, StatusCode::not_found);
}

}  // namespace
}  // namespace bpa::io
