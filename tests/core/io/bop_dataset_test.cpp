// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/bop_dataset.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

Pose some_pose() {
  return {Eigen::Quaterniond(0.5, -0.1, 0.7, 0.3).normalized(), {0.01, -0.02, 0.8}};
}

BopMesh some_mesh() {
  BopMesh model;
  model.obj_id = 7;
  model.name = "cup";
  model.diameter = 0.123;
  model.symmetry.discrete = {{Eigen::Quaterniond(0, 0, 1, 0), {0.001, 0, 0}}};
  model.symmetry.continuous = {{Eigen::Vector3d(0, 0.6, 0.8), {0.01, 0.02, 0.03}}};
  model.mesh.vertices = {{0, 0, 0}, {0.05f, 0, 0}, {0, 0.06f, 0}};
  model.mesh.triangles = {{0, 1, 2}};
  return model;
}

Frame some_frame() {
  Frame frame;
  frame.camera = {32, 24, 30.5, 31.5, 15.25, 12.75};
  frame.depth.assign(32 * 24, 0.5f);
  frame.depth[3] = 0;
  frame.color.assign(3 * 32 * 24, 9);
  return frame;
}

TEST(BopDataset, ModelsSurviveWritingAndReading) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_bop_models(folder.path(), {some_mesh()}).ok());
  const auto models = read_bop_models(folder.path());
  ASSERT_TRUE(models.ok()) << models.status().message;
  ASSERT_EQ(models->size(), 1u);
  const BopModel& model = models->front();
  EXPECT_EQ(model.obj_id, 7);
  EXPECT_EQ(model.name, "cup");
  EXPECT_NEAR(model.diameter, 0.123, 1e-12);
  ASSERT_EQ(model.symmetry.discrete.size(), 1u);
  EXPECT_NEAR(model.symmetry.discrete[0].translation.x(), 0.001, 1e-12);
  ASSERT_EQ(model.symmetry.continuous.size(), 1u);
  EXPECT_LT((model.symmetry.continuous[0].point - Eigen::Vector3d(0.01, 0.02, 0.03)).norm(), 1e-12);
  const auto mesh = read_mesh(model.path, 0.001);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  EXPECT_LT((mesh->vertices[2] - some_mesh().mesh.vertices[2]).norm(), 1e-6f);
}

TEST(BopDataset, DeepSymmetriesAreRefused) {
  const test::TemporaryFolder folder;
  const std::size_t levels = 200'000;
  test::spill(folder / "models_info.json", R"({"7": {"diameter": 1, "symmetries_continuous": )" +
                                               std::string(levels, '[') + std::string(levels, ']') +
                                               "}}");
  EXPECT_EQ(read_bop_models_folder(folder.path()).status().code, StatusCode::corrupt);
}

TEST(BopDataset, FramesSurviveWritingAndReading) {
  const test::TemporaryFolder folder;
  const Frame frame = some_frame();
  BopInstanceRecord record;
  record.obj_id = 7;
  record.camera_from_object = some_pose();
  record.mask.assign(32 * 24, 0);
  record.mask_visible.assign(32 * 24, 0);
  for (const std::size_t i : {2u, 3u, 4u, 34u}) record.mask[i] = 1;
  for (const std::size_t i : {2u, 34u, 4u}) record.mask_visible[i] = 1;
  BopSceneWriter writer(folder.path(), "val", 12, 0.1);
  ASSERT_TRUE(writer.add(5, frame, {record}).ok());
  ASSERT_TRUE(writer.add(2, frame, {}).ok());
  ASSERT_TRUE(writer.finish().ok());

  const auto frames = read_bop_frames(folder.path(), "val");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  ASSERT_EQ(frames->size(), 2u);
  EXPECT_EQ(frames->at(0).im_id, 2);
  EXPECT_TRUE(frames->at(0).has_truth);
  EXPECT_TRUE(frames->at(0).truth.empty());
  const BopFrame& entry = frames->at(1);
  EXPECT_EQ(entry.scene_id, 12);
  ASSERT_EQ(entry.truth.size(), 1u);
  EXPECT_EQ(entry.truth[0].visible_fraction, 0.75);
  const PoseError error = pose_error(entry.truth[0].camera_from_object, some_pose());
  EXPECT_LT(error.position, 1e-12);
  EXPECT_LT(error.angle, 1e-7);
  const auto loaded = load_bop_frame(entry);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message;
  EXPECT_EQ(loaded->camera.fx, frame.camera.fx);
  EXPECT_EQ(loaded->camera.cy, frame.camera.cy);
  EXPECT_EQ(loaded->color, frame.color);
  EXPECT_NEAR(loaded->depth[0], 0.5f, 1e-6);
  EXPECT_EQ(loaded->depth[3], 0);
  const auto mask = read_gray_png(folder / "val/000012/mask_visib/000005_000000.png");
  ASSERT_TRUE(mask.ok());
  EXPECT_EQ(mask->pixels[34], 255);
  EXPECT_EQ(mask->pixels[3], 0);
}

TEST(BopDataset, SequencesKeepStampsCamerasAndIdentities) {
  const test::TemporaryFolder folder;
  Frame frame = some_frame();
  BopInstanceRecord record;
  record.obj_id = 7;
  record.camera_from_object = some_pose();
  record.mask_visible.assign(32 * 24, 1);
  record.instance = 3;
  BopSceneWriter writer(folder.path(), "test", 1, 1.0, BopMasks::counted);
  constexpr std::int64_t kStamp = 1'700'000'000'033'333'333;
  frame.stamp_ns = kStamp;
  ASSERT_TRUE(writer.add(4, frame, {record}, some_pose()).ok());
  frame.stamp_ns = 0;
  record.instance = 0;
  ASSERT_TRUE(writer.add(2, frame, {record}).ok());
  record.mask_visible.pop_back();
  EXPECT_EQ(writer.add(9, frame, {record}).code, StatusCode::invalid_argument);
  ASSERT_TRUE(writer.finish().ok());
  EXPECT_FALSE(std::filesystem::exists(folder / "test/000001/mask_visib"));
  const auto frames = read_bop_frames(folder.path(), "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  ASSERT_EQ(frames->size(), 2u);
  EXPECT_FALSE(frames->at(0).camera_from_world);
  EXPECT_EQ(frames->at(0).stamp_ns, 0);
  EXPECT_EQ(frames->at(0).truth.at(0).instance, 0);
  EXPECT_EQ(frames->at(1).im_id, 4);
  EXPECT_EQ(frames->at(1).stamp_ns, kStamp);
  EXPECT_EQ(load_bop_frame(frames->at(1))->stamp_ns, kStamp);
  EXPECT_EQ(frames->at(1).truth.at(0).instance, 3);
  ASSERT_TRUE(frames->at(1).camera_from_world);
  const PoseError error = pose_error(*frames->at(1).camera_from_world, some_pose());
  EXPECT_LT(error.position, 1e-12);
  EXPECT_LT(error.angle, 1e-7);
}

TEST(BopDataset, SaysWhatIsMissing) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(read_bop_models(folder.path()).status().code, StatusCode::not_found);
  EXPECT_EQ(read_bop_frames(folder.path(), "test").status().code, StatusCode::not_found);
  BopSceneWriter writer(folder.path(), "test", 1);
  ASSERT_TRUE(writer.add(0, some_frame(), {}).ok());
  ASSERT_TRUE(writer.finish().ok());
  const Status status = read_bop_frames(folder.path(), "test", {1, 3}).status();
  EXPECT_EQ(status.code, StatusCode::not_found);
  EXPECT_NE(status.message.find("scene 3"), std::string::npos);
  test::spill(folder / "test/000001/scene_gt.json", R"({"0": [{"obj_id": 1}]})");
  EXPECT_EQ(read_bop_frames(folder.path(), "test").status().code, StatusCode::corrupt);
  EXPECT_NE(
      read_bop_frames(folder.path(), "val").status().message.find("its folders: test (--split"),
      std::string::npos);
}

/// Formats that are not read are refused with the way out, frame by frame.
TEST(BopDataset, ImagesOfOtherFormats) {
  const test::TemporaryFolder folder;
  test::spill(folder / "val/000001/scene_camera.json",
              R"({"3": {"cam_K": [500, 0, 320, 0, 501, 240, 0, 0, 1]}})");
  std::filesystem::create_directories(folder / "val/000001/depth");
  test::spill(folder / "val/000001/depth/000003.tif", "II*         ");
  const auto frames = read_bop_frames(folder.path(), "val");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  const std::string said = load_bop_frame(frames->at(0)).status().message;
  EXPECT_NE(said.find("000003.tif is no depth image in PNG, PGM or npy; write it as npy"),
            std::string::npos)
      << said;
}

TEST(BopDataset, RealFrames) {
  const std::string data = test::real_data();
  if (data.empty()) GTEST_SKIP() << "no real frames";
  const auto models = read_bop_models(data + "/ycbv");
  ASSERT_TRUE(models.ok()) << models.status().message;
  EXPECT_EQ(models->size(), 21u);
  EXPECT_EQ(models->front().name, "002_master_chef_can");
  EXPECT_NEAR(models->front().diameter, 0.1715, 1e-3);
  const auto frames = read_bop_frames(data + "/ycbv", "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  ASSERT_EQ(frames->size(), 8u);
  std::size_t instances = 0;
  for (const BopFrame& frame : *frames) instances += frame.truth.size();
  EXPECT_EQ(instances, 32u);
  const auto frame = load_bop_frame(frames->front());
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_TRUE(validate(*frame).ok());
}

/// Grey images, several cameras and CAD models have names of their own in BOP's industrial sets.
TEST(BopDataset, ReadsVariantsOfTheLayout) {
  namespace fs = std::filesystem;
  const test::TemporaryFolder folder;
  BopSceneWriter writer(folder.path(), "val", 1);
  BopInstanceRecord instance;
  instance.obj_id = 7;
  instance.camera_from_object = some_pose();
  ASSERT_TRUE(writer.add(5, some_frame(), {instance}).ok());
  ASSERT_TRUE(writer.finish().ok());
  ASSERT_TRUE(write_bop_models(folder.path(), {some_mesh()}).ok());
  const auto expected = read_bop_frames(folder.path(), "val");
  ASSERT_TRUE(expected.ok());
  fs::rename(folder / "models", folder / "models_cad");
  EXPECT_EQ(read_bop_models(folder.path())->size(), 1u);
  const std::string scene = folder / "val/000001/";
  fs::rename(scene + "rgb", scene + "gray");
  EXPECT_EQ(read_bop_frames(folder.path(), "val")->at(0).color_path, scene + "gray/000005.png");
  fs::rename(scene + "gray", scene + "rgb_cam1");
  fs::rename(scene + "depth", scene + "depth_cam1");
  for (const std::string name : {"scene_camera", "scene_gt", "scene_gt_info"}) {
    fs::rename(scene + name + ".json", scene + name + "_cam1.json");
  }
  const auto frames = read_bop_frames(folder.path(), "val");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  EXPECT_EQ(frames->at(0).color_path, scene + "rgb_cam1/000005.png");
  EXPECT_EQ(frames->at(0).truth.at(0).obj_id, 7);
  EXPECT_EQ(load_bop_frame(frames->at(0))->depth, some_frame().depth);
  test::spill(scene + "info.yml", "0:\n  cam_K: [1]\n");
  const Status old = read_bop_frames(folder.path(), "val").status();
  EXPECT_NE(old.message.find("SIXD and LINEMOD"), std::string::npos) << old.message;
}

/// A matrix that stands column by column, which gave a principal point of zero.
TEST(BopDataset, ACameraThatIsNoneIsRefusedByItsImage) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_gray_png(folder / "val/000001/depth/000003.png", {2, 1, {1, 2}}).ok());
  test::spill(folder / "val/000001/scene_camera.json",
              R"({"3": {"cam_K": [500, 0, 0, 0, 501, 0, 320, 240, 1]}})");
  const auto frames = read_bop_frames(folder.path(), "val");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  const Status status = load_bop_frame(frames->at(0)).status();
  EXPECT_NE(status.message.find("scene_camera.json: 3: the third row"), std::string::npos)
      << status.message;
}

}  // namespace
}  // namespace bpa::io
