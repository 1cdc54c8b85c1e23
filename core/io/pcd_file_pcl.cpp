// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The only file of this room that sees PCL. PCDReader crashes on a header without DATA and prints
// what it does not like, so the header is checked here first.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include "core/base/concat.hpp"
#include "core/io/pcd_file.hpp"

namespace bpa::io {
namespace {

constexpr std::uint64_t kMaxPoints = 50'000'000;

/// Whether a header is complete and its counts are sane.
Status check_header(const std::string& path) {
  std::error_code error;
  std::ifstream in(path, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(path, error)) {
    return not_found(path, " cannot be opened");
  }
  std::set<std::string> keys;
  std::uint64_t width = 0, height = 1, points = 0;
  std::string line;
  while (std::getline(in, line) && line.size() < 4096) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key.empty() || key[0] == '#') continue;
    if (keys.empty() && key != "VERSION" && key != "FIELDS") break;
    keys.insert(key);
    if (key == "WIDTH") words >> width;
    if (key == "HEIGHT") words >> height;
    if (key == "POINTS") words >> points;
    if (!words && (key == "WIDTH" || key == "HEIGHT" || key == "POINTS")) {
      return corrupt(path, " has a PCD header whose ", key, " is not a number");
    }
    if (key == "DATA") break;
  }
  for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "POINTS", "DATA"}) {
    if (keys.count(key) == 0) return corrupt(path, " is not a PCD file: no ", key);
  }
  if (width > kMaxPoints || height > kMaxPoints || width * height != points) {
    return corrupt(path, " has a PCD header whose POINTS is not WIDTH x HEIGHT");
  }
  if (points == 0 || points > kMaxPoints) {
    return invalid_argument(path, " has ", points, " points; it must have 1 to ", kMaxPoints);
  }
  return {};
}

const pcl::PCLPointField* find_field(const pcl::PCLPointCloud2& blob, const char* name,
                                     bool real = true) {
  for (const pcl::PCLPointField& field : blob.fields) {
    if (field.name != name) continue;
    if (real && field.datatype != pcl::PCLPointField::FLOAT32) continue;
    if (field.offset + 4 <= blob.point_step) return &field;
  }
  return nullptr;
}

/// Three float fields as vectors; empty unless all are there.
std::vector<Eigen::Vector3f> read_vectors(const pcl::PCLPointCloud2& blob, const char* x,
                                          const char* y, const char* z) {
  const pcl::PCLPointField* fields[] = {find_field(blob, x), find_field(blob, y),
                                        find_field(blob, z)};
  if (!fields[0] || !fields[1] || !fields[2]) return {};
  std::vector<Eigen::Vector3f> vectors(std::size_t{blob.width} * blob.height);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      std::memcpy(&vectors[i][k], &blob.data[i * blob.point_step + fields[k]->offset], 4);
    }
  }
  return vectors;
}

std::vector<std::array<std::uint8_t, 3>> read_colors(const pcl::PCLPointCloud2& blob) {
  const pcl::PCLPointField* field = find_field(blob, "rgb", false);
  if (field == nullptr) field = find_field(blob, "rgba", false);
  if (field == nullptr) return {};
  std::vector<std::array<std::uint8_t, 3>> colors(std::size_t{blob.width} * blob.height);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const std::uint8_t* bgra = &blob.data[i * blob.point_step + field->offset];
    colors[i] = {bgra[2], bgra[1], bgra[0]};
  }
  return colors;
}

}  // namespace

Result<PcdCloud> read_pcd(const std::string& path) {
  if (Status status = check_header(path); !status.ok()) return status;
  pcl::PCLPointCloud2 blob;
  const pcl::console::VERBOSITY_LEVEL verbosity = pcl::console::getVerbosityLevel();
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  int outcome = -1;
  try {
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0;
    outcome = pcl::PCDReader().read(path, blob, origin, orientation, version);
  } catch (const std::exception&) {
    outcome = -1;
  }
  pcl::console::setVerbosityLevel(verbosity);
  const std::size_t count = std::size_t{blob.width} * blob.height;
  if (outcome < 0 || count == 0 || blob.data.size() < count * blob.point_step) {
    return corrupt(path, " is truncated or damaged");
  }
  PcdCloud cloud;
  cloud.width = static_cast<int>(blob.width);
  cloud.height = static_cast<int>(blob.height);
  cloud.points = read_vectors(blob, "x", "y", "z");
  if (cloud.points.empty()) return invalid_argument(path, " has no float fields x, y and z");
  cloud.normals = read_vectors(blob, "normal_x", "normal_y", "normal_z");
  cloud.colors = read_colors(blob);
  return cloud;
}

}  // namespace bpa::io
