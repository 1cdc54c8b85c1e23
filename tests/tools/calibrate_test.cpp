// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa calibrate board on rendered images, against the cameras that they were rendered for.
#include <gtest/gtest.h>

#include "core/io/camera_file.hpp"
#include "core/io/camera_poses_file.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "tests/support/board_image.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command.hpp"

namespace bpa::cli {
namespace {

int run(std::vector<std::string> words) {
  words.insert(words.begin(), "bpa");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  return run_bpa(static_cast<int>(arguments.size()), arguments.data());
}

TEST(CalibrateBoard, WritesWhereTheCamerasAre) {
  const test::TemporaryFolder folder;
  const Camera& camera = test::kBoardCamera;
  const Pose left = test::look_at({0.1, -0.4, 0.5}, {0.1, -0.06, 0});
  const Pose right = test::look_at({0.5, 0.1, 0.4}, {0.1, -0.06, 0});
  ASSERT_TRUE(io::write_file(folder / "camera.json", io::camera_json(camera, 1)).ok());
  for (const auto& [name, pose] : {std::pair{"left", left}, std::pair{"right", right}}) {
    ASSERT_TRUE(io::write_color_png(folder / (std::string(name) + ".png"),
                                    {camera.width, camera.height, test::board_image(pose)})
                    .ok());
  }
  const std::vector<std::string> words = {"calibrate",
                                          "board",
                                          "--images",
                                          folder / "left.png",
                                          folder / "right.png",
                                          "--camera",
                                          folder / "camera.json",
                                          "--square-mm",
                                          "30",
                                          "--out",
                                          folder / "cameras.json"};
  auto with_corners = [&](const std::string& corners) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--corners", corners});
    return all;
  };
  EXPECT_EQ(run(with_corners("8,6")), 1);
  ASSERT_EQ(run(with_corners("8,5")), 0);
  const auto found = io::read_camera_poses(folder / "cameras.json");
  ASSERT_TRUE(found.ok()) << found.status().message;
  ASSERT_EQ(found->size(), 2u);
  EXPECT_EQ((*found)[0].name, "left");
  EXPECT_EQ((*found)[1].name, "right");
  EXPECT_LT(pose_error((*found)[0].scene_from_camera, left.inverse()).position, 0.002);
  EXPECT_LT(pose_error((*found)[1].scene_from_camera, right.inverse()).position, 0.002);
}

}  // namespace
}  // namespace bpa::cli
