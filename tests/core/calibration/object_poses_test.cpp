// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/object_poses.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/support/solid_scene.hpp"

namespace bpa::calibration {
namespace {

constexpr double kDegreeOfTurn = std::numbers::pi / 180;

// Six objects of five models about the origin: cans that spin, boxes, and a part without symmetry.
struct Object {
  std::string model;
  Pose world_from_object;
};

SymmetryGroup symmetry_of(const std::string& model) {
  SymmetryGroup out;
  if (model == "can") out.continuous.push_back({});
  if (model == "box") {
    out.discrete.push_back({Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()});
  }
  return out;
}

class ObjectPoses : public ::testing::Test {
 protected:
  ObjectPoses() {
    for (const char* model : {"can", "can", "box", "mug", "tool", "plate"}) {
      objects_.push_back({model, {turn(3), draw(0.25)}});
    }
    for (const Eigen::Vector3d& eye :
         {Eigen::Vector3d(0.1, -0.7, 0.6), {0.7, 0.1, 0.5}, {-0.5, 0.5, 0.6}}) {
      cameras_.push_back(test::look_at(eye, {0, 0, 0}).inverse());
    }
  }
  Eigen::Vector3d draw(double size) {
    const double x = random_.uniform(-size, size), y = random_.uniform(-size, size);
    return {x, y, random_.uniform(-size, size)};
  }
  Eigen::Quaterniond turn(double angle) { return rotation_from_vector(draw(angle)); }

  // What a camera sees of an object: off by some millimetres and a degree, turned by its symmetry.
  Placement seen(const Object& object, const Pose& world_from_camera) {
    Placement out;
    out.model = object.model;
    out.frame_from_object = world_from_camera.inverse() * object.world_from_object;
    if (object.model == "can") {
      out.frame_from_object =
          out.frame_from_object * test::standing_at(0, 0, 0, random_.uniform(-3, 3));
    }
    out.frame_from_object.rotation = turn(kDegreeOfTurn) * out.frame_from_object.rotation;
    out.frame_from_object.translation += draw(0.002);
    return out;
  }
  std::vector<SeenObjects> moment() {
    std::vector<SeenObjects> out;
    for (const Pose& camera : cameras_) {
      SeenObjects& of_one = out.emplace_back();
      for (const Object& object : objects_) of_one.push_back(seen(object, camera));
    }
    return out;
  }

  RandomStream random_{3, 1};
  std::vector<Object> objects_;
  std::vector<Pose> cameras_;  // world_from_camera
};

TEST_F(ObjectPoses, AreThoseOfTheCameras) {
  const std::vector<std::vector<SeenObjects>> moments{moment()};
  const auto found = cameras_from_objects(moments, symmetry_of, cameras_[0]);
  ASSERT_TRUE(found.ok()) << found.status().message;
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    const PoseError error = pose_error((*found)[c].scene_from_camera, cameras_[c]);
    EXPECT_LT(error.position, 0.01) << c;
    EXPECT_LT(error.angle, 0.8 * kDegreeOfTurn) << c;
    if (c > 0) {
      EXPECT_EQ((*found)[c].objects, 6);
    }
  }
}

TEST_F(ObjectPoses, FalsePositivesAndMissedObjectsDoNotMatter) {
  std::vector<std::vector<SeenObjects>> moments{moment()};
  for (SeenObjects& of_one : moments[0]) {
    of_one.erase(of_one.begin() + random_.index(6));
    const Object wrong{"mug", {turn(3), draw(0.3)}};
    of_one.push_back(seen(wrong, cameras_[0]));
  }
  const auto found = cameras_from_objects(moments, symmetry_of, cameras_[0]);
  ASSERT_TRUE(found.ok()) << found.status().message;
  for (std::size_t c = 1; c < cameras_.size(); ++c) {
    EXPECT_LT(pose_error((*found)[c].scene_from_camera, cameras_[c]).position, 0.012) << c;
  }
}

TEST_F(ObjectPoses, SeveralMomentsAreMoreExact) {
  std::vector<std::vector<SeenObjects>> moments;
  for (int m = 0; m < 8; ++m) {
    for (Object& object : objects_) object.world_from_object = {turn(3), draw(0.25)};
    moments.push_back(moment());
  }
  const auto found = cameras_from_objects(moments, symmetry_of, cameras_[0]);
  ASSERT_TRUE(found.ok()) << found.status().message;
  for (std::size_t c = 1; c < cameras_.size(); ++c) {
    EXPECT_LT(pose_error((*found)[c].scene_from_camera, cameras_[c]).position, 0.004) << c;
    EXPECT_EQ((*found)[c].objects, 48);
  }
}

TEST_F(ObjectPoses, TooFewObjectsAreNotEnough) {
  std::vector<std::vector<SeenObjects>> moments{moment()};
  moments[0][2].erase(moments[0][2].begin() + 1, moments[0][2].end());
  const auto found = cameras_from_objects(moments, symmetry_of);
  EXPECT_EQ(found.status().code, StatusCode::not_found);
  EXPECT_EQ(found.status().message,
            "camera 2 sees 1 objects where other cameras see them; at least 2 are needed");
  moments[0].resize(1);
  EXPECT_EQ(cameras_from_objects(moments, symmetry_of).status().message,
            "there are 1 cameras; there must be at least 2");
}

}  // namespace
}  // namespace bpa::calibration
