// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/pcd_file.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "core/io/mesh_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::slurp;
using test::spill;

/// What a camera sees of a wavy surface; with a hole of NaN.
PcdCloud wavy(const Camera& camera) {
  PcdCloud cloud;
  cloud.width = camera.width;
  cloud.height = camera.height;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double z = 1 + 0.1 * std::sin(0.3 * u) + 0.05 * std::cos(0.2 * v);
      cloud.points.push_back(camera.unproject(u, v, z).cast<float>());
      if (u < 5) cloud.points.back().setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  return cloud;
}

TEST(OrganisedCloud, FindsTheCamera) {
  const Camera camera{64, 48, 60.5, 61.25, 30.5, 25};
  const Result<OrganisedFrame> frame = frame_from_organised_cloud(wavy(camera));
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  const Camera& found = frame->frame.camera;
  EXPECT_NEAR(found.fx, camera.fx, 1e-3);
  EXPECT_NEAR(found.fy, camera.fy, 1e-3);
  EXPECT_NEAR(found.cx, camera.cx, 1e-3);
  EXPECT_NEAR(found.cy, camera.cy, 1e-3);
  EXPECT_EQ(frame->frame.depth[0], 0);
  EXPECT_GT(frame->frame.depth[10], 0.8f);
  EXPECT_NEAR(rotation_angle(frame->cloud_from_camera.rotation, Eigen::Quaterniond::Identity()), 0,
              1e-12);
  EXPECT_EQ(frame->notes.size(), 1u);
}

TEST(OrganisedCloud, TurnsACloudWithYUpAndZTowardTheViewer) {
  const Camera camera{64, 48, 60, 60, 31.5, 23.5};
  PcdCloud cloud = wavy(camera);
  const PcdCloud optical = cloud;
  for (Eigen::Vector3f& p : cloud.points) p = Eigen::Vector3f(p.x(), -p.y(), -p.z());
  const Result<OrganisedFrame> frame = frame_from_organised_cloud(cloud);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_EQ(frame->notes.size(), 2u);
  const std::size_t i = 20 * 64 + 40;
  EXPECT_FLOAT_EQ(frame->frame.depth[i], optical.points[i].z());
  const Eigen::Vector3d back = frame->cloud_from_camera * optical.points[i].cast<double>();
  EXPECT_LT((back - cloud.points[i].cast<double>()).norm(), 1e-6);
}

TEST(OrganisedCloud, RefusesWhatNoCameraSees) {
  PcdCloud cloud = wavy(Camera{64, 48, 60, 60, 31.5, 23.5});
  PcdCloud flat = cloud;
  flat.width *= flat.height;
  flat.height = 1;
  EXPECT_EQ(frame_from_organised_cloud(flat).status().code, StatusCode::invalid_argument);
  PcdCloud nothing = cloud;
  for (auto& p : nothing.points) p.setConstant(std::numeric_limits<float>::quiet_NaN());
  const Status status = frame_from_organised_cloud(nothing).status();
  EXPECT_EQ(status.code, StatusCode::invalid_argument);
  EXPECT_NE(status.message.find("500"), std::string::npos);
  PcdCloud mixed = cloud;
  for (std::size_t i = 0; i < mixed.points.size(); i += 2) mixed.points[i].z() *= -1;
  EXPECT_FALSE(frame_from_organised_cloud(mixed).ok());
  PcdCloud shuffled = cloud;
  std::reverse(shuffled.points.begin(), shuffled.points.end());
  EXPECT_FALSE(frame_from_organised_cloud(shuffled).ok());
}

TEST(PcdFile, ReadsAsciiWithColorAndDropsInvalidPoints) {
  const test::TemporaryFolder folder;
  spill(folder / "a.pcd",
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
        "WIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n"
        "1 2 3 66051\nnan nan nan 0\n4 5 6 16711680\n");
  const Result<PointCloud> cloud = read_point_cloud(folder / "a.pcd", 0.001);
  ASSERT_TRUE(cloud.ok()) << cloud.status().message;
  ASSERT_EQ(cloud->size(), 2u);
  EXPECT_LT((cloud->points[1] - Eigen::Vector3f(0.004f, 0.005f, 0.006f)).norm(), 1e-7f);
  ASSERT_EQ(cloud->colors.size(), 2u);
  EXPECT_EQ(cloud->colors[0], (std::array<std::uint8_t, 3>{1, 2, 3}));
  EXPECT_EQ(cloud->colors[1], (std::array<std::uint8_t, 3>{255, 0, 0}));
}

TEST(PcdFile, BadFilesAreStatuses) {
  const test::TemporaryFolder folder;
  spill(folder / "a.pcd", "hello\n");
  EXPECT_EQ(read_pcd(folder / "a.pcd").status().code, StatusCode::corrupt);
  spill(folder / "scene.ply", "ply\nformat ascii 1.0\n");
  EXPECT_NE(
      read_pcd(folder / "scene.ply")
          .status()
          .message.find(
              "begins with \"ply\". A frame is an organised PCD cloud, which has rows of pixels, "
              "or a depth image (--depth FILE --camera FILE)"),
      std::string::npos);
  spill(folder / "d.npy", "\x93NUMPY\x01\n");
  EXPECT_NE(read_pcd(folder / "d.npy").status().message.find("begins with \"\"."),
            std::string::npos);
  spill(folder / "b.pcd",
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 9\nHEIGHT 9\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 81\nDATA binary\nshort");
  EXPECT_EQ(read_pcd(folder / "b.pcd").status().code, StatusCode::corrupt);
  spill(folder / "c.pcd",
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4000000000\n"
        "HEIGHT 4000000000\nPOINTS 5\nDATA binary\n");
  EXPECT_EQ(read_pcd(folder / "c.pcd").status().code, StatusCode::corrupt);
  EXPECT_EQ(read_pcd(folder / "none.pcd").status().code, StatusCode::not_found);
  EXPECT_EQ(read_pcd(folder.path()).status().code, StatusCode::not_found);
}

TEST(PcdFile, HeadersThatDoNotFitAreCorrupt) {
  const std::string good =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n";
  ASSERT_TRUE(parse_pcd(good, "a").ok()) << parse_pcd(good, "a").status().message;
  const std::pair<const char*, const char*> changes[] = {
      {"VERSION 0.7\n", "#7\nVERSION \nF\n"},  // a line of its own that is none
      {"TYPE F F F", "TYPE"},
      {"TYPE F F F", "TYPE F F"},
      {"TYPE F F F", "TYPE F F X"},
      {"SIZE 4 4 4", "SIZE 4 "},
      {"SIZE 4 4 4", "SIZE 4 4 3"},
      {"SIZE 4 4 4", "SIZE 4 4 18446744073709551615"},
      {"COUNT 1 1 1", "COUNT 1 1"},
      {"COUNT 1 1 1", "COUNT 1 1 4000000000"},
      {"COUNT 1 1 1", "COUNT 1 1 -1"},
      {"FIELDS x y z", "FIELDS"},
      {"FIELDS x y z", "FIELDS x y z w"},
      {"WIDTH 1", "WIDTH"},
      {"WIDTH 1", "WIDTH 1\nWIDTH 1"},
      {"POINTS 1", "POINTS 2"},
      {"DATA ascii", "DATA"},
      {"DATA ascii", "DATA rubbish"},
      {"DATA ascii", "DATA binary_compressed"},
      {"1 2 3\n", "1 2\n"},
      {"1 2 3\n", "1 2 3 4\n"},
      {"1 2 3\n", "1 2 three\n"},
  };
  for (const auto& [part, other] : changes) {
    std::string text = good;
    text.replace(text.find(part), std::string(part).size(), other);
    const auto cloud = parse_pcd(text, "a.pcd");
    EXPECT_EQ(cloud.status().code, StatusCode::corrupt) << part << " -> " << other;
    EXPECT_EQ(cloud.status().message.find("a.pcd "), 0U) << cloud.status().message;
  }
  for (std::size_t size = 0; size + 2 < good.size(); ++size) {
    EXPECT_EQ(parse_pcd(good.substr(0, size), "a").status().code, StatusCode::corrupt) << size;
  }
}

/// Points of three fields that are stored field by field, as literal runs of LZF.
std::string compressed_pcd(std::uint32_t points, std::uint32_t claimed) {
  std::string fields;
  for (int k = 1; k <= 3; ++k) {
    for (std::uint32_t i = 0; i < points; ++i) {
      const float value = static_cast<float>(10 * k) + static_cast<float>(i);
      fields.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  std::string runs;
  for (std::size_t at = 0; at < fields.size(); at += 32) {
    const std::string run = fields.substr(at, 32);
    runs += static_cast<char>(run.size() - 1);
    runs += run;
  }
  const auto size = static_cast<std::uint32_t>(runs.size());
  const std::uint32_t sizes[2] = {size, 12 * claimed};
  const std::string width = std::to_string(claimed);
  std::string bytes = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " + width +
                      "\nPOINTS " + width + "\nDATA binary_compressed\n";
  bytes.append(reinterpret_cast<const char*>(sizes), sizeof sizes);
  return bytes + runs;
}

TEST(PcdFile, CompressedPoints) {
  const auto cloud = parse_pcd(compressed_pcd(50, 50), "a");
  ASSERT_TRUE(cloud.ok()) << cloud.status().message;
  ASSERT_EQ(cloud->points.size(), 50u);
  EXPECT_EQ(cloud->points[49], Eigen::Vector3f(59, 69, 79));
  // 600 bytes do not unpack to 600 MB, and no memory is taken for them.
  EXPECT_EQ(parse_pcd(compressed_pcd(50, 50'000'000), "a").status().code, StatusCode::corrupt);
  EXPECT_EQ(parse_pcd(compressed_pcd(50, 51), "a").status().code, StatusCode::corrupt);
  std::string bytes = compressed_pcd(50, 50);
  for (std::size_t size = bytes.size() - 1; size > bytes.size() - 600; size -= 37) {
    EXPECT_EQ(parse_pcd(bytes.substr(0, size), "a").status().code, StatusCode::corrupt);
  }
}

TEST(PcdFile, RealClouds) {
  const std::string data = test::real_data();
  if (data.empty()) GTEST_SKIP() << "no real frames";
  const Result<PcdCloud> milk = read_pcd(data + "/pcl_milk/milk_cartoon_all_small_clorox.pcd");
  ASSERT_TRUE(milk.ok()) << milk.status().message;
  const Result<OrganisedFrame> frame = frame_from_organised_cloud(*milk);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_EQ(frame->notes.size(), 2u);
  EXPECT_NEAR(frame->frame.camera.fx, 525, 1);
  EXPECT_NEAR(frame->frame.camera.fy, 525, 1);
  const Result<PcdCloud> osd = read_pcd(data + "/osd_clutter/learn20.pcd");
  ASSERT_TRUE(osd.ok()) << osd.status().message;
  const Result<OrganisedFrame> clutter = frame_from_organised_cloud(*osd);
  ASSERT_TRUE(clutter.ok()) << clutter.status().message;
  EXPECT_NEAR(clutter->frame.camera.fx, 525, 1);
  EXPECT_NEAR(clutter->frame.camera.cx, 319.5, 1);
  EXPECT_EQ(clutter->frame.color.size(), 3u * 640 * 480);
  const std::string bytes = slurp(data + "/pcl_milk/milk.pcd");
  const test::TemporaryFolder folder;
  for (const std::size_t size : {bytes.size() - 5000, bytes.size() / 2, std::size_t{180}}) {
    spill(folder / "cut.pcd", bytes.substr(0, size));
    EXPECT_EQ(read_pcd(folder / "cut.pcd").status().code, StatusCode::corrupt) << size;
  }
}

}  // namespace
}  // namespace bpa::io
