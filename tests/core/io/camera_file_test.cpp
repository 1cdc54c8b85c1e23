// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_file.hpp"

#include <gtest/gtest.h>

#include "core/io/file_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::spill;

TEST(CameraFile, BopJson) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(
      write_file(folder / "camera.json", camera_json({640, 480, 525.5, 526, 319.5, 239}, 0.1))
          .ok());
  const Result<CameraFile> file = read_camera(folder / "camera.json");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->camera.width, 640);
  EXPECT_EQ(file->camera.fx, 525.5);
  EXPECT_EQ(file->camera.cy, 239);
  EXPECT_EQ(file->depth_scale_mm, 0.1);
}

TEST(CameraFile, RosCameraInfo) {
  const test::TemporaryFolder folder;
  spill(folder / "c.yaml",
        "image_width: 640\nimage_height: 480\ncamera_name: x\ncamera_matrix:\n  rows: 3\n  cols: "
        "3\n  data: [525, 0, 319.5, 0, 526, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n"
        "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0, 0, 0, 0]\n");
  const Result<CameraFile> file = read_camera(folder / "c.yaml");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->camera.fy, 526);
  EXPECT_EQ(file->camera.height, 480);
  EXPECT_FALSE(file->note.empty());
}

TEST(CameraFile, NamesTheFieldAndTheRule) {
  const test::TemporaryFolder folder;
  spill(folder / "c.json", R"({"fx": 0, "fy": 500, "cx": 1, "cy": 1})");
  Status status = read_camera(folder / "c.json").status();
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  EXPECT_NE(status.message.find("fx is 0; it must be positive"), std::string::npos);
  spill(folder / "c.json", R"({"fx": 500, "cx": 1, "cy": 1})");
  status = read_camera(folder / "c.json").status();
  EXPECT_EQ(status.code, StatusCode::corrupt);
  EXPECT_NE(status.message.find("fy"), std::string::npos);
  spill(folder / "c.json", R"({"fx": 500, )");
  EXPECT_EQ(read_camera(folder / "c.json").status().code, StatusCode::corrupt);
  spill(folder / "c.yaml", "image_width: [1");
  EXPECT_EQ(read_camera(folder / "c.yaml").status().code, StatusCode::corrupt);
}

}  // namespace
}  // namespace bpa::io
