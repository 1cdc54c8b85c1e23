// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa detect --views on a data set of two views, against the objects' poses in the world.
#include "tools/detect_views.hpp"

#include <gtest/gtest.h>

#include "core/base/failure.hpp"
#include "core/io/camera_poses_file.hpp"
#include "core/io/image_file.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::cli {
namespace {

class DetectViews : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto library = std::make_shared<ModelLibrary>();
    EXPECT_TRUE(library->add(test::l_model()).ok());
    library_ = library;
  }
  static void TearDownTestSuite() { library_.reset(); }

  // One scene: an L on a table from two places, and from one of them again.
  void write(const std::string& split, bool posed) {
    io::BopSceneWriter writer(folder_.path(), split, 1, 0.1);
    int im_id = 0;
    for (const Eigen::Vector3d& eye :
         {Eigen::Vector3d(0.1, -0.6, 0.5), {-0.5, 0.3, 0.45}, {0.1, -0.6, 0.5}}) {
      const Pose camera_from_world = test::look_at(eye, {0, 0, 0});
      const auto solids = test::together({test::table(camera_from_world)},
                                         test::l_solids(camera_from_world * truth_));
      Frame frame = test::render(solids, test::kinect_camera(), 1, 8).frame;
      std::optional<Pose> pose;
      if (posed) pose = camera_from_world;
      EXPECT_TRUE(writer.add(im_id++, frame, {}, pose).ok());
    }
    EXPECT_TRUE(writer.finish().ok());
  }

  std::vector<io::FrameResult> detected(const DetectArguments& a) {
    const auto entries = io::read_bop_frames(folder_.path(), a.dataset.split);
    EXPECT_TRUE(entries.ok()) << entries.status().message;
    return detect_joined(a, *entries, Detector(library_, {}), {},
                         [](const std::string&, const io::FrameResult&) {});
  }
  std::string failure(const DetectArguments& a) {
    try {
      detected(a);
    } catch (const Failure& error) {
      return error.what();
    }
    return "";
  }
  DetectArguments arguments(const std::string& split) {
    write(split, split == "test");
    DetectArguments a;
    a.dataset.folder = folder_.path();
    a.dataset.split = split;
    a.views = 2;
    return a;
  }
  static void expect_found(const io::FrameResult& result, const Pose& truth) {
    ASSERT_EQ(result.interpretations.at(0).placements.size(), 1u);
    const Pose& pose = result.interpretations[0].placements[0].frame_from_object;
    EXPECT_LT(pose_error(pose, truth).position, 0.003);
    EXPECT_LT(pose_error(pose, truth).angle, 0.02);
  }

  static inline const Pose truth_ = test::standing_at(-0.08, 0, 0.02, 0.7);
  static inline std::shared_ptr<const ModelLibrary> library_;
  const test::TemporaryFolder folder_;
};

TEST_F(DetectViews, JoinsSoManyImagesOfASceneInTheWorld) {
  DetectArguments a = arguments("test");
  a.annotate = folder_ / "pictures";
  const auto results = detected(a);
  ASSERT_EQ(results.size(), 2u);  // images 0 and 1, then 2 alone
  EXPECT_EQ(results[0].im_id, 0);
  EXPECT_EQ(results[1].im_id, 2);
  for (const io::FrameResult& result : results) expect_found(result, truth_);
  for (const char* file : {"000001_000000.png", "000001_000001.png", "000001_000002.png"}) {
    EXPECT_TRUE(io::read_color_image(a.annotate + "/" + file).ok()) << file;
  }
}

TEST_F(DetectViews, TakesPosesFromAFile) {
  // The fixed frame is that of the first camera.
  const Pose first = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
  const Pose second = test::look_at({-0.5, 0.3, 0.45}, {0, 0, 0});
  DetectArguments a = arguments("unposed");
  a.poses = folder_ / "cameras.json";
  ASSERT_TRUE(
      io::write_camera_poses(a.poses, {{"left", Pose{}}, {"right", first * second.inverse()}})
          .ok());
  expect_found(detected(a).at(0), first * truth_);
  a.views = 3;
  EXPECT_EQ(failure(a), a.poses + " has 2 cameras; --views asks for 3");
}

TEST_F(DetectViews, AsksForPoses) {
  EXPECT_EQ(failure(arguments("unposed")),
            "scene 1 image 0 has no pose of its camera: give --poses, or cam_R_w2c and cam_t_w2c "
            "in scene_camera.json");
}

}  // namespace
}  // namespace bpa::cli
