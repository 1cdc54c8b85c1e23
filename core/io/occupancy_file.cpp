// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/occupancy_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/io/private/byte_stream.hpp"

namespace bpa::io {
namespace {

constexpr std::string_view kMagic = "bpaoccup";
constexpr float kMost = std::numeric_limits<std::uint16_t>::max();
constexpr float kMostSigned = std::numeric_limits<std::int16_t>::max();
constexpr float kPi = 3.14159265358979f;

// `value` in [0, 1].
void append_share(std::string& bytes, float value) {
  append(bytes, static_cast<std::uint16_t>(std::lround(kMost * std::clamp(value, 0.0f, 1.0f))));
}

float next_share(ByteReader& reader) {
  return static_cast<float>(reader.next<std::uint16_t>()) / kMost;
}

void append_bucket(std::string& bytes, const ViewBucket& bucket, const Eigen::Vector3f& corner,
                   float cell) {
  append(bytes, static_cast<std::uint32_t>(bucket.rays));
  append_share(bytes, bucket.occupancy);
  const Eigen::Vector3f inside = (bucket.position - corner) / cell;
  for (int a = 0; a < 3; ++a) append_share(bytes, inside[a]);
  for (int a = 0; a < 3; ++a) {
    append(bytes, static_cast<std::int16_t>(
                      std::lround(kMostSigned * std::clamp(bucket.normal[a], -1.0f, 1.0f))));
  }
  append_share(bytes, std::sqrt(std::max(0.0f, bucket.normal_variance)) / kPi);
}

ViewBucket read_bucket(ByteReader& reader, const Eigen::Vector3f& corner, float cell) {
  ViewBucket bucket;
  bucket.rays = static_cast<int>(
      std::min<std::uint32_t>(reader.next<std::uint32_t>(), std::numeric_limits<int>::max()));
  bucket.occupancy = next_share(reader);
  for (int a = 0; a < 3; ++a) bucket.position[a] = corner[a] + cell * next_share(reader);
  for (int a = 0; a < 3; ++a) {
    bucket.normal[a] = static_cast<float>(reader.next<std::int16_t>()) / kMostSigned;
  }
  bucket.normal.normalize();
  const float deviation = kPi * next_share(reader);
  bucket.normal_variance = deviation * deviation;
  return bucket;
}

Eigen::Vector3f corner_of(const OccupancyGrid& grid, const Eigen::Vector3i& place) {
  return grid.low + grid.cell * place.cast<float>();
}

// Fills the cells; false when they do not fit the grid or the bytes.
bool read_cells(ByteReader& reader, std::uint64_t count, OccupancyGrid& grid) {
  constexpr std::size_t kSmallestCell = 3 * sizeof(std::uint16_t) + 1;
  if (count > reader.left() / kSmallestCell) return false;
  grid.cells.resize(static_cast<std::size_t>(count));
  for (OccupancyCell& cell : grid.cells) {
    for (int a = 0; a < 3; ++a) cell.place[a] = reader.next<std::uint16_t>();
    if ((cell.place.array() >= grid.size.array()).any()) return false;
    const auto which = reader.next<std::uint8_t>();
    if (which > 3) return false;
    for (std::size_t b = 0; b < cell.buckets.size(); ++b) {
      if ((which >> b & 1) == 0) continue;
      cell.buckets[b] = read_bucket(reader, corner_of(grid, cell.place), grid.cell);
    }
  }
  return reader.finished();
}

}  // namespace

Result<std::string> occupancy_bytes(const OccupancyGrid& grid) {
  if (grid.size.maxCoeff() > static_cast<int>(kMost)) {
    return Status(StatusCode::unsupported, "an occupancy grid of more than 65535 cells a side");
  }
  std::string bytes(kMagic);
  append(bytes, kOccupancyVersion);
  append(bytes, grid.low);
  append(bytes, grid.cell);
  append(bytes, grid.size);
  append(bytes, static_cast<std::uint64_t>(grid.cells.size()));
  for (const OccupancyCell& cell : grid.cells) {
    for (int a = 0; a < 3; ++a) append(bytes, static_cast<std::uint16_t>(cell.place[a]));
    const bool first = cell.buckets[0].rays > 0, second = cell.buckets[1].rays > 0;
    append(bytes, static_cast<std::uint8_t>((first ? 1 : 0) | (second ? 2 : 0)));
    for (const ViewBucket& bucket : cell.buckets) {
      if (bucket.rays > 0) append_bucket(bytes, bucket, corner_of(grid, cell.place), grid.cell);
    }
  }
  return bytes;
}

Result<OccupancyGrid> parse_occupancy(const std::string& bytes, const std::string& name) {
  const auto damaged = [&name](const std::string& why) {
    return Status(StatusCode::corrupt, name + why);
  };
  if (std::string_view(bytes).substr(0, kMagic.size()) != kMagic) {
    return damaged(" is not an occupancy grid");
  }
  ByteReader reader(std::string_view(bytes).substr(kMagic.size()));
  if (const auto version = reader.next<std::uint32_t>(); version != kOccupancyVersion) {
    return damaged(" has format version " + std::to_string(version) +
                   "; this program reads version " + std::to_string(kOccupancyVersion) +
                   ": make the model again");
  }
  OccupancyGrid grid;
  for (int a = 0; a < 3; ++a) grid.low[a] = reader.next<float>();
  grid.cell = reader.next<float>();
  for (int a = 0; a < 3; ++a) grid.size[a] = reader.next<std::int32_t>();
  const auto count = reader.next<std::uint64_t>();
  const bool legal = reader.ok() && grid.cell > 0 && grid.low.allFinite() &&
                     grid.size.minCoeff() >= 0 && grid.size.maxCoeff() <= static_cast<int>(kMost);
  if (!legal || !read_cells(reader, count, grid)) return damaged(" is damaged");
  return grid;
}

}  // namespace bpa::io
