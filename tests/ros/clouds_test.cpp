// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "ros/frames.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa::ros {
namespace {

using support::kHeight;
using support::kWidth;
using wire::sensor_msgs::PointCloud2;
using wire::sensor_msgs::PointField;

/// The slanted wall as a cloud with padded points and rows, such as depth_image_proc makes.
PointCloud2 wall_cloud() {
  PointCloud2 cloud;
  cloud.header = support::header(9);
  cloud.width = kWidth;
  cloud.height = kHeight;
  cloud.point_step = 32;
  cloud.row_step = 32 * kWidth + 64;
  cloud.point_fields = {{"x", 0, PointField::kFloat32, 1},
                        {"y", 4, PointField::kFloat32, 1},
                        {"z", 8, PointField::kFloat32, 1},
                        {"rgb", 16, PointField::kFloat32, 1}};
  cloud.data.assign(cloud.row_step * kHeight, 0xee);
  const auto depth = support::wall_depth_mm();
  const auto rgb = support::wall_rgb();
  for (std::size_t v = 0; v < kHeight; ++v) {
    for (std::size_t u = 0; u < kWidth; ++u) {
      const std::size_t i = v * kWidth + u;
      const auto z = static_cast<float>(depth[i] * 0.001);
      const float point[3] = {(static_cast<float>(u) - 31.5f) * z / 60,
                              (static_cast<float>(v) - 23.5f) * z / 60, z};
      std::uint8_t* to = cloud.data.data() + v * cloud.row_step + u * cloud.point_step;
      std::memcpy(to, point, sizeof point);
      const std::uint8_t packed[4] = {rgb[3 * i + 2], rgb[3 * i + 1], rgb[3 * i], 0};
      std::memcpy(to + 16, packed, sizeof packed);
    }
  }
  return cloud;
}

TEST(FrameFromCloud, EqualsTheFrameMessage) {
  PointCloud2 cloud = wall_cloud();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 3; ++i) std::memcpy(cloud.data.data() + 4 * i, &nan, 4);
  const auto frame = frame_from_cloud(cloud);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  const auto expected = frame_from_message(support::wall_frame());
  EXPECT_EQ(frame->stamp_ns, 9);
  EXPECT_EQ(frame->frame_id, "wall_camera");
  EXPECT_NEAR(frame->camera.fx, 60, 1e-3);
  EXPECT_NEAR(frame->camera.cy, 23.5, 1e-3);
  EXPECT_EQ(frame->color, expected->color);
  ASSERT_EQ(frame->depth.size(), expected->depth.size());
  EXPECT_EQ(frame->depth[0], 0);
  for (std::size_t i = 1; i < frame->depth.size(); ++i) {
    EXPECT_EQ(frame->depth[i], expected->depth[i]) << i;
  }
}

/// Its points turned by `change`.
PointCloud2 changed_cloud(const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& change) {
  PointCloud2 cloud = wall_cloud();
  for (std::size_t v = 0; v < kHeight; ++v) {
    for (std::size_t u = 0; u < kWidth; ++u) {
      std::uint8_t* at = cloud.data.data() + v * cloud.row_step + u * cloud.point_step;
      Eigen::Vector3f point;
      std::memcpy(point.data(), at, 12);
      point = change(point);
      std::memcpy(at, point.data(), 12);
    }
  }
  return cloud;
}

TEST(FrameFromCloud, IsInMetresOfAnyUnit) {
  const auto metres = frame_from_cloud(wall_cloud());
  const auto in_unit = [](float unit, double said) {
    return frame_from_cloud(
        changed_cloud([unit](const Eigen::Vector3f& p) { return Eigen::Vector3f(p / unit); }),
        said);
  };
  EXPECT_TRUE(metres.note().empty());
  for (const auto& frame : {in_unit(0.001f, 0), in_unit(0.001f, 0.001), in_unit(0.01f, 0.01)}) {
    ASSERT_TRUE(frame.ok()) << frame.status().message;
    EXPECT_NEAR(frame->camera.fx, 60, 1e-3);
    for (std::size_t i = 0; i < frame->depth.size(); ++i) {
      ASSERT_NEAR(frame->depth[i], metres->depth[i], 1e-6f);
    }
  }
  EXPECT_NE(in_unit(0.001f, 0).note().find("taken for millimetres"), std::string::npos);
}

TEST(FrameFromCloud, OfTheRobotsBaseIsRefusedWithTheReason) {
  // A camera that looks straight down, and one that looks ahead.
  for (const bool down : {true, false}) {
    const auto frame = frame_from_cloud(changed_cloud([down](const Eigen::Vector3f& p) {
      return down ? Eigen::Vector3f(p.x(), -p.y(), 1.5f - p.z())
                  : Eigen::Vector3f(p.z(), -p.x(), 0.4f - p.y());
    }));
    ASSERT_FALSE(frame.ok());
    EXPECT_NE(frame.status().message.find("robot's base (frame_id \"wall_camera\")"),
              std::string::npos)
        << frame.status().message;
  }
}

TEST(FrameFromCloud, RefusesWhatIsNoCamerasCloud) {
  const auto refused = [](const char* word, auto spoil) {
    PointCloud2 cloud = wall_cloud();
    spoil(cloud);
    const auto frame = frame_from_cloud(cloud);
    ASSERT_FALSE(frame.ok()) << word;
    EXPECT_NE(frame.status().message.find(word), std::string::npos) << frame.status().message;
  };
  refused("organised", [](PointCloud2& c) {
    c.width *= c.height;
    c.height = 1;
  });
  refused("bytes", [](PointCloud2& c) { c.data.pop_back(); });
  refused("row_step", [](PointCloud2& c) { c.row_step = 8; });
  refused("row_step", [](PointCloud2& c) { c.point_step = 0xffffffff; });
  refused("is_bigendian", [](PointCloud2& c) { c.is_bigendian = true; });
  refused("x, y and z", [](PointCloud2& c) { c.point_fields[2].name = "depth"; });
  refused("x, y and z", [](PointCloud2& c) { c.point_fields[2].datatype = PointField::kFloat64; });
  refused("x, y and z", [](PointCloud2& c) { c.point_fields[2].offset = 30; });
  refused("x, y and z", [](PointCloud2& c) { c.point_fields[2].offset = 0xfffffffe; });
  refused("between 1 and", [](PointCloud2& c) { c.width = 0; });
  // A cloud in the body frame of a robot: z forward is not its third field.
  refused("", [](PointCloud2& c) {
    std::swap(c.point_fields[0].offset, c.point_fields[2].offset);
    std::swap(c.point_fields[0].offset, c.point_fields[1].offset);
  });
}

}  // namespace
}  // namespace bpa::ros
