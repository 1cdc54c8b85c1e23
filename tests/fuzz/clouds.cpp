// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// PCD files, and frames made of them.
#include <cstring>

#include "core/io/pcd_file.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

void run_pcd(std::string_view bytes) {
  const auto cloud = io::parse_pcd(bytes, "cloud.pcd");
  if (!cloud.ok()) return;
  const std::size_t n = static_cast<std::size_t>(cloud->width) * cloud->height;
  require(cloud->points.size() == n, "a cloud has all its points");
  require(cloud->normals.empty() || cloud->normals.size() == n, "each point has a normal or none");
  require(cloud->colors.empty() || cloud->colors.size() == n, "each point has a colour or none");
  for (const auto& p : io::drop_invalid_points(*cloud).points) {
    require(p.allFinite(), "valid points are finite");
  }
  const auto organised = io::frame_from_organised_cloud(*cloud);
  if (organised.ok()) require(validate(organised->frame.camera).ok(), "its camera is legal");
}

std::string header(const std::string& fields, int width, int height, const std::string& data) {
  const std::string size = std::to_string(width), rows = std::to_string(height);
  return "# .PCD v0.7\nVERSION 0.7\n" + fields + "WIDTH " + size + "\nHEIGHT " + rows +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA " + data +
         "\n";
}

constexpr const char* kXyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
constexpr const char* kColored =
    "FIELDS x y z rgb label\nSIZE 4 4 4 4 2\nTYPE F F F U U\nCOUNT 1 1 1 1 2\n";

/// What a pinhole camera sees of a slanted wall.
std::string wall(int width, int height) {
  std::string bytes;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const float z = 1.0f + 0.01f * static_cast<float>(u + v);
      const float xyz[3] = {z * static_cast<float>(u - 15) / 30,
                            z * static_cast<float>(v - 12) / 30, z};
      bytes.append(reinterpret_cast<const char*>(xyz), sizeof xyz);
    }
  }
  return bytes;
}

/// LZF of bytes that are all literals: runs of up to 32, each behind its length.
std::string compressed(const std::string& bytes) {
  std::string stream;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    stream += static_cast<char>(run.size() - 1);
    stream += run;
  }
  const std::uint32_t sizes[2] = {static_cast<std::uint32_t>(stream.size()),
                                  static_cast<std::uint32_t>(bytes.size())};
  return std::string(reinterpret_cast<const char*>(sizes), sizeof sizes) + stream;
}

std::vector<std::string> pcd_seeds() {
  return {header(kXyz, 2, 1, "ascii") + "0 0.5 1e-3\nnan -1 2\n",
          header(kColored, 1, 2, "ascii") + "0 0.5 1 4294967295 1 2\n1 2 3 255 0 0\n",
          header(kXyz, 3, 1, "binary") + std::string(36, '\1'),
          header(kXyz, 30, 24, "binary") + wall(30, 24),
          header(kXyz, 2, 2, "binary_compressed") + compressed(wall(2, 2)),
          header("FIELDS normal_x normal_y normal_z z y x rgba\nSIZE 4 4 4 4 4 4 4\n"
                 "TYPE F F F F F F U\n",
                 1, 1, "ascii") +
              "0 0 1 +1 2 3 16711680\n"};
}

}  // namespace

std::vector<Target> cloud_targets() {
  return {{"pcd", "core/io/pcd_file_pcl.cpp core/io/organised_cloud.cpp", run_pcd, pcd_seeds, 16384,
           2}};
}

}  // namespace bpa::fuzz
