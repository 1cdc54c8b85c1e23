// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Scans drawn ray by ray of shapes that are known in closed form, on a plate in front of a wall.
#include "core/modeling/turntable.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace bpa::modeling {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kCanHeight = 0.1;  // metres

// An L of two boxes, which looks different from all sides; z up from the plate.
struct Box {
  Eigen::Vector3d low, high;
};
const Box kFoot{{-0.05, -0.03, 0}, {0.05, 0.03, 0.035}};
const Box kTower{{-0.05, -0.03, 0.035}, {-0.015, 0.02, 0.095}};

// Where a ray enters a box, infinite where it does not.
double enter(const Box& box, const Eigen::Vector3d& from, const Eigen::Vector3d& d) {
  double near = 0, far = 1e9;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (box.low[a] - from[a]) / d[a], t1 = (box.high[a] - from[a]) / d[a];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near < far ? near : 1e9;
}

// The same for an upright cylinder about (0, 0).
double enter_cylinder(double radius, double low, double high, const Eigen::Vector3d& from,
                      const Eigen::Vector3d& d) {
  double best = 1e9;
  const double cap = (high - from.z()) / d.z();
  if (cap > 0 && (from + cap * d).head<2>().norm() < radius) best = cap;
  const double a = d.head<2>().squaredNorm(), b = from.head<2>().dot(d.head<2>());
  const double root = b * b - a * (from.head<2>().squaredNorm() - radius * radius);
  if (root < 0) return best;
  const double side = (-b - std::sqrt(root)) / a, z = from.z() + side * d.z();
  return side > 0 && z > low && z < high ? std::min(best, side) : best;
}

struct Stage {
  bool object = true;
  bool can = false;  // the object is a can on the axis instead
  double true_step = 10 * kDegree;
  Pose plate_from_object;  // before any turn
  Eigen::Vector2d axis{0.012, -0.018};
  double noise = 0.0015;
};

// The camera looks down at the plate's middle; world: z = 0 is the plate.
Pose world_from_camera() {
  const Eigen::Vector3d eye(0, -0.6, 0.45);
  const Eigen::Vector3d forward = (Eigen::Vector3d(0, 0, 0.03) - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  return Pose::from_matrix(axes, eye);
}

Pose world_from_object(const Stage& stage, int k) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(stage.true_step * k, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d c(stage.axis.x(), stage.axis.y(), 0);
  return Pose{turn, c} * stage.plate_from_object;
}

Frame image(const Stage& stage, int k, std::uint64_t seed) {
  Frame frame;
  frame.camera = {320, 240, 290, 290, 159.5, 119.5};
  frame.depth.assign(320 * 240, 0);
  RandomStream random(seed, static_cast<std::uint64_t>(k));
  const Pose world = world_from_camera();
  const Pose object_from_world = world_from_object(stage, k).inverse();
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const Eigen::Vector3d d = world.rotation * frame.camera.unproject(u, v, 1);
      const Eigen::Vector3d& eye = world.translation;
      double t = enter_cylinder(0.15, -0.02, 0, eye, d);  // the plate
      const double table = (-0.02 - eye.z()) / d.z();     // 2 cm below
      if (table > 0) t = std::min(t, table);
      t = std::min(t, (0.9 - eye.y()) / d.y() > 0 ? (0.9 - eye.y()) / d.y() : 1e9);  // a wall
      if (stage.can) {
        const Eigen::Vector3d axis(stage.axis.x(), stage.axis.y(), 0);
        t = std::min(t, enter_cylinder(0.035, 0, kCanHeight, eye - axis, d));
      } else if (stage.object) {
        const Eigen::Vector3d from = object_from_world * eye,
                              along = object_from_world.rotation * d;
        t = std::min({t, enter(kFoot, from, along), enter(kTower, from, along)});
      }
      if (t < 3)
        frame.depth[static_cast<std::size_t>(v * 320 + u)] =
            static_cast<float>(t + stage.noise * random.normal());
    }
  }
  return frame;
}

std::vector<ScanView> scan(const Stage& stage, int count, std::uint64_t seed) {
  std::vector<ScanView> views;
  for (int k = 0; k < count; ++k) {
    ScanView view;
    view.view = make_posed_view(image(stage, k, seed), {}, Pose{});
    view.view.id = k;
    view.step = k;
    views.push_back(std::move(view));
  }
  return views;
}

// The distance of the found centre from the true axis, in the plane of the plate.
double centre_error(const RestingPosition& found, const Stage& stage) {
  const Eigen::Vector3d centre = world_from_camera() * found.centre;
  return (centre.head<2>() - stage.axis).norm();
}

TEST(Turntable, CentreOfRotationIsFound) {
  Stage stage;
  stage.plate_from_object.translation = {0.01, 0.015, 0};
  ScanOptions options;
  const auto found = align_resting_position(scan(stage, 36, 1), options);
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_LT(centre_error(*found, stage), 0.001);
  EXPECT_NEAR(found->step_deg, 10, 0.05);
  EXPECT_EQ(found->views.size(), 36u);
  EXPECT_EQ(found->missed, 0);
  const Eigen::Vector3d up = world_from_camera().rotation * found->axis;
  EXPECT_GT(up.z(), std::cos(0.3 * kDegree));
  // The poses belong together: that of each view against the first is the truth.
  const auto relative = [](const Pose& a, const Pose& b) { return a * b.inverse(); };
  for (const PosedView& view : found->views) {
    const Pose camera_from_world = world_from_camera().inverse();
    const Pose truth = relative(camera_from_world * world_from_object(stage, view.id),
                                camera_from_world * world_from_object(stage, 0));
    const Pose mine = relative(view.camera_from_object, found->views[0].camera_from_object);
    const Pose error = truth.inverse() * mine;
    const Eigen::Vector3d middle = world_from_camera().inverse() * Eigen::Vector3d(0, 0, 0.04);
    EXPECT_LT((error * middle - middle).norm(), 0.002);
  }
}

TEST(Turntable, WrongStepAndSenseAreFound) {
  for (const double step : {10.4, -9.7}) {  // told: 10
    Stage stage;
    stage.true_step = step * kDegree;
    const auto found = align_resting_position(scan(stage, 18, 2), {});
    ASSERT_TRUE(found.ok()) << found.status().message;
    EXPECT_NEAR(found->step_deg, step, 0.15);
    EXPECT_LT(centre_error(*found, stage), 0.001);
  }
}

// Nothing changes while it turns; what carries it is the plate, not the table under it.
TEST(Turntable, ObjectThatLooksAlikeFromAllSidesStandsOnThePlate) {
  Stage stage;
  stage.can = true;
  auto found = align_resting_position(scan(stage, 12, 12), {});
  ASSERT_TRUE(found.ok()) << found.status().message;
  const Eigen::Vector3d up = world_from_camera().rotation * found->plane.normal.cast<double>();
  EXPECT_GT(up.z(), std::cos(0.5 * kDegree));
  EXPECT_NEAR((world_from_camera() * found->centre).z(), 0, 0.003);
  EXPECT_LT(centre_error(*found, stage), 0.002);
  const int other = found->step_deg > 0 ? -1 : 1;  // fits as well; others know which is right
  find_axis(*found, other, {});
  EXPECT_NEAR(found->step_deg, 10 * other, 0.5);
  EXPECT_LT(centre_error(*found, stage), 0.002);
}

TEST(Turntable, FramesWithoutTheObjectAreLeftOut) {
  Stage stage, empty;
  empty.object = false;
  std::vector<ScanView> views = scan(stage, 18, 3);
  const std::vector<ScanView> nothing = scan(empty, 18, 4);
  for (const std::size_t k : {3, 4, 17}) views[k] = nothing[k];
  const auto found = align_resting_position(views, {});
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_EQ(found->missed, 3);
  EXPECT_LT(centre_error(*found, stage), 0.0012);
}

TEST(Turntable, EmptyTurntableIsSaid) {
  Stage empty;
  empty.object = false;
  const auto found = align_resting_position(scan(empty, 6, 5), {});
  EXPECT_EQ(found.status().code, StatusCode::not_found);
  EXPECT_NE(found.status().message.find("nothing stands on the turntable"), std::string::npos)
      << found.status().message;
  EXPECT_EQ(align_resting_position({}, {}).status().code, StatusCode::not_found);
}

TEST(Turntable, RestingPositionsAreMerged) {
  Stage upright, lying;
  // On its back: what was +x points down.
  lying.plate_from_object.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY());
  lying.plate_from_object.translation = {-0.03, 0.01, 0.05};
  const auto aligned = align_scan({scan(upright, 24, 6), scan(lying, 24, 7)}, {});
  ASSERT_TRUE(aligned.ok()) << aligned.status().message;
  EXPECT_TRUE(aligned->warnings.empty()) << aligned->warnings.front();
  ASSERT_EQ(aligned->views.size(), 48u);
  const Pose camera_from_world = world_from_camera().inverse();
  const Pose model_from_object = aligned->views[0].camera_from_object.inverse() *
                                 camera_from_world * world_from_object(upright, 0);
  const Pose second = aligned->views[24].camera_from_object.inverse() * camera_from_world *
                      world_from_object(lying, 0);
  const Pose error = model_from_object.inverse() * second;
  EXPECT_LT(rotation_angle(error.rotation, Eigen::Quaterniond::Identity()), 2.0 * kDegree);
  EXPECT_LT((error * Eigen::Vector3d(-0.02, 0, 0.04) - Eigen::Vector3d(-0.02, 0, 0.04)).norm(),
            0.003);
  // The model: on the surface of the boxes, and nearly all of it there.
  const auto model = model_source_from_views(aligned->views, "l", 1);
  ASSERT_TRUE(model.ok()) << model.status().message;
  int close = 0;
  for (const Eigen::Vector3f& p : model->surface.points) {
    const Eigen::Vector3d q = model_from_object.inverse() * p.cast<double>();
    const auto off = [&q](const Box& b) {
      const Eigen::Vector3d e = (b.low - q).cwiseMax(q - b.high);
      return e.cwiseMax(0.0).norm() + std::min(0.0, e.maxCoeff());
    };
    close += std::abs(std::min(off(kFoot), off(kTower))) < 0.002;
  }
  EXPECT_GT(close, 0.95 * static_cast<double>(model->surface.size()));
  EXPECT_TRUE(model->noise.fitted);
  EXPECT_NEAR(model->noise.range.floor, 0.001, 0.0007);
}

// A can is put upside down: it looks as before, and its side slides along itself.
TEST(Turntable, CanUpsideDownKeepsItsHeight) {
  Stage can;
  can.can = true;
  const auto aligned = align_scan({scan(can, 24, 11), scan(can, 24, 12)}, {});
  ASSERT_TRUE(aligned.ok()) << aligned.status().message;
  ASSERT_EQ(aligned->views.size(), 48u);
  const auto model = model_source_from_views(aligned->views, "can", 1);
  ASSERT_TRUE(model.ok()) << model.status().message;
  std::vector<float> top, bottom;
  for (std::size_t i = 0; i < model->surface.size(); ++i) {
    const float up = model->surface.normals[i].z(), z = model->surface.points[i].z();
    if (up > 0.98f) top.push_back(z);
    if (up < -0.98f) bottom.push_back(z);
  }
  ASSERT_GT(top.size(), 100u);
  ASSERT_GT(bottom.size(), 100u) << "seen in the second position only";
  for (auto* heights : {&top, &bottom}) std::sort(heights->begin(), heights->end());
  EXPECT_NEAR(top[top.size() / 2] - bottom[bottom.size() / 2], kCanHeight, 0.0015);
}

TEST(Turntable, MissingRestingPositionIsSaid) {
  Stage stage, empty;
  empty.object = false;
  const auto aligned = align_scan({scan(stage, 24, 8), scan(empty, 6, 9)}, {});
  ASSERT_TRUE(aligned.ok()) << aligned.status().message;
  ASSERT_EQ(aligned->warnings.size(), 1u);
  EXPECT_NE(aligned->warnings[0].find("resting position 2 was left out"), std::string::npos);
  const auto model = model_source_from_views(aligned->views, "l", 1);
  ASSERT_TRUE(model.ok());
  std::string all;
  for (const std::string& w : model->warnings) all += w + "\n";
  EXPECT_NE(all.find("never seen, most of it from -z"), std::string::npos) << "its foot: " << all;
  EXPECT_FALSE(align_scan({}, {}).ok());
}

}  // namespace
}  // namespace bpa::modeling
