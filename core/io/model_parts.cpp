// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/model_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/io/model_file.hpp"
#include "core/io/private/byte_stream.hpp"
#include "core/io/private/json_file.hpp"

namespace bpa {

NLOHMANN_JSON_SERIALIZE_ENUM(SymmetryOrigin, {{SymmetryOrigin::none, "none"},
                                              {SymmetryOrigin::declared, "declared"},
                                              {SymmetryOrigin::found, "found"}})

static void fields(auto& visit, io::Is<ContinuousSymmetry> auto& symmetry) {
  visit("axis", symmetry.axis);
  visit("point_m", symmetry.point);
}

static void fields(auto& visit, io::Is<NoiseCurve> auto& curve) {
  visit("floor", curve.floor);
  visit("edge_height", curve.edge_height);
  visit("edge_place_m", curve.edge_place);
  visit("edge_width_m", curve.edge_width);
  visit("angle_height", curve.angle_height);
  visit("angle_place", curve.angle_place);
  visit("angle_width", curve.angle_width);
}

static void fields(auto& visit, io::Is<NoiseModel> auto& noise) {
  visit("range_m", noise.range);
  visit("normal_rad", noise.normal);
  visit("depth_m", noise.depth);
  visit("fitted", noise.fitted);
}

namespace io {

static constexpr const char* kFormat = "bpa model";

static void fields(auto& visit, Is<FileRecord> auto& record) {
  visit("bytes", record.bytes);
  visit("crc32", record.crc32);
}

static void fields(auto& visit, Is<ModelDescription> auto& description) {
  auto& model = description.model;
  visit("name", model.name);
  visit("number", model.number);
  visit("source", model.source);
  visit("diameter_m", model.diameter);
  visit("complete", model.complete);
  visit.group("symmetries", [&model](auto group) {
    group("origin", model.symmetry_origin);
    group("discrete", model.symmetry.discrete);
    group("continuous", model.symmetry.continuous);
  });
  visit("noise", model.noise);
  visit("warnings", model.warnings);
  visit("points", description.points);
  visit("files", description.files);
}

std::string description_text(const ModelDescription& description) {
  Json json = description;
  json["format"] = kFormat;
  json["version"] = kModelFileVersion;
  return json.dump(1) + "\n";
}

Result<ModelDescription> read_description(const std::string& path) {
  return read_json(path, [&](const Json& json) -> Result<ModelDescription> {
    if (json.value("format", "") != kFormat) {
      return corrupt(path, " is not a model of this program");
    }
    const int version = json.at("version").get<int>();
    if (version == kModelFileVersion) return json.get<ModelDescription>();
    return corrupt(path, " has format version ", version, "; this program reads version ",
                   kModelFileVersion,
                   ": make the model again (bpa model from-mesh, from-bop or from-scans)");
  });
}

namespace {

constexpr std::string_view kIndexMagic = "bpaindex";

// Calls visit(array) for every array of the file. `index` is const when writing.
void for_each_array(auto& index, const auto& visit) {
  visit(index.soft_normals);
  for (auto* cloud : {&index.features, &index.coarse}) {
    visit(cloud->points);
    visit(cloud->normals);
    visit(cloud->principal_directions);
    visit(cloud->curvatures);
    visit(cloud->colors);
  }
  visit(index.fpfh);
  for (auto& view : index.views) {
    visit(view.visible);
    visit(view.edge_distance);
    visit(view.edges);
    visit(view.outward);
  }
  visit(index.distances.nearest);
}

bool below(const std::vector<std::uint32_t>& indices, std::size_t limit) {
  return std::all_of(indices.begin(), indices.end(), [limit](auto i) { return i < limit; });
}

bool fits_cloud(const PointCloud& cloud, bool curved) {
  const std::size_t n = cloud.size();
  return cloud.normals.size() == n && (cloud.colors.empty() || cloud.colors.size() == n) &&
         cloud.curvatures.size() == (curved ? n : 0) &&
         cloud.principal_directions.size() == (curved ? n : 0);
}

// Whatever the bytes were, nothing that reads the index may leave an array.
bool fits_together(const IndexFile& file, std::size_t points) {
  const ModelIndex& index = *file.index;
  bool fits = file.normal_variance.size() == points && index.soft_normals.size() == points &&
              fits_cloud(index.features, true) && fits_cloud(index.coarse, false) &&
              index.fpfh.size() == index.features.size() && below(index.distances.nearest, points);
  for (const ModelView& view : index.views) {
    fits = fits && view.edge_distance.size() == view.visible.size() &&
           view.outward.size() == view.edges.size() && below(view.visible, points) &&
           below(view.edges, points);
  }
  const DistanceTransform& t = index.distances;
  constexpr int kMostCells = 4096;
  return fits && t.cell > 0 && t.size.minCoeff() >= 1 && t.size.maxCoeff() <= kMostCells &&
         static_cast<double>(t.nearest.size()) == t.size.cast<double>().prod();
}

constexpr std::string_view kOccupancyMagic = "bpaoccup";
constexpr std::uint32_t kOccupancyVersion = 1;
constexpr float kMost = std::numeric_limits<std::uint16_t>::max();
constexpr float kMostSigned = std::numeric_limits<std::int16_t>::max();
constexpr float kPi = 3.14159265358979f;

struct StoredBucket {
  std::uint32_t rays;
  std::uint16_t occupancy;    // of 65535
  std::uint16_t position[3];  // mean, of the cell's side, from its corner
  std::int16_t normal[3];     // mean, of 32767
  std::uint16_t deviation;    // standard deviation of normals, of pi
};
static_assert(sizeof(StoredBucket) == 20, "written as it is");

// `value` in [0, 1].
std::uint16_t to_share(float value) {
  return static_cast<std::uint16_t>(std::lround(kMost * std::clamp(value, 0.0f, 1.0f)));
}

float from_share(std::uint16_t share) { return static_cast<float>(share) / kMost; }

Eigen::Vector3f corner_of(const OccupancyGrid& grid, const Eigen::Vector3i& place) {
  return grid.low + grid.cell * place.cast<float>();
}

StoredBucket stored(const ViewBucket& bucket, const Eigen::Vector3f& corner, float cell) {
  StoredBucket out;
  out.rays = static_cast<std::uint32_t>(bucket.rays);
  out.occupancy = to_share(bucket.occupancy);
  const Eigen::Vector3f inside = (bucket.position - corner) / cell;
  for (int a = 0; a < 3; ++a) {
    out.position[a] = to_share(inside[a]);
    out.normal[a] = static_cast<std::int16_t>(
        std::lround(kMostSigned * std::clamp(bucket.normal[a], -1.0f, 1.0f)));
  }
  out.deviation = to_share(std::sqrt(std::max(0.0f, bucket.normal_variance)) / kPi);
  return out;
}

ViewBucket restored(const StoredBucket& in, const Eigen::Vector3f& corner, float cell) {
  ViewBucket bucket;
  bucket.rays = static_cast<int>(std::min<std::uint32_t>(in.rays, std::numeric_limits<int>::max()));
  bucket.occupancy = from_share(in.occupancy);
  for (int a = 0; a < 3; ++a) {
    bucket.position[a] = corner[a] + cell * from_share(in.position[a]);
    bucket.normal[a] = static_cast<float>(in.normal[a]) / kMostSigned;
  }
  bucket.normal.normalize();
  const float deviation = kPi * from_share(in.deviation);
  bucket.normal_variance = deviation * deviation;
  return bucket;
}

// Fills the cells; false when they do not fit the grid or the bytes.
bool read_cells(ByteReader& reader, std::uint64_t count, OccupancyGrid& grid) {
  constexpr std::size_t kSmallestCell = 3 * sizeof(std::uint16_t) + 1;
  if (count > reader.left() / kSmallestCell) return false;
  grid.cells.resize(count);
  for (OccupancyCell& cell : grid.cells) {
    for (int a = 0; a < 3; ++a) cell.place[a] = reader.next<std::uint16_t>();
    if ((cell.place.array() >= grid.size.array()).any()) return false;
    const auto which = reader.next<std::uint8_t>();
    if (which > 3) return false;
    for (std::size_t b = 0; b < cell.buckets.size(); ++b) {
      if ((which >> b & 1) == 0) continue;
      StoredBucket bucket{};
      reader.value(bucket);
      cell.buckets[b] = restored(bucket, corner_of(grid, cell.place), grid.cell);
    }
  }
  return reader.finished();
}

}  // namespace

std::string index_bytes(const ModelIndex& index, const std::vector<float>& normal_variance) {
  std::string bytes(kIndexMagic);
  append(bytes, static_cast<std::uint32_t>(kIndexVersion));
  append(bytes, index.distances.low);
  append(bytes, index.distances.cell);
  append(bytes, index.distances.size);
  append_array(bytes, normal_variance);
  for_each_array(index, [&bytes](const auto& array) { append_array(bytes, array); });
  return bytes;
}

Result<IndexFile> parse_index(const std::string& bytes, std::size_t points,
                              const std::string& name) {
  const Status damaged = corrupt(name, " does not fit the surface beside it");
  if (std::string_view(bytes).substr(0, kIndexMagic.size()) != kIndexMagic) return damaged;
  ByteReader reader(std::string_view(bytes).substr(kIndexMagic.size()));
  const auto version = reader.next<std::uint32_t>();
  IndexFile file;
  file.index = std::make_shared<ModelIndex>();
  ModelIndex& index = *file.index;
  reader.value(index.distances.low);
  reader.value(index.distances.cell);
  reader.value(index.distances.size);
  reader.array(file.normal_variance);
  if (version != kIndexVersion) {  // what follows may be anything
    file.index.reset();
    if (file.normal_variance.size() != points) return damaged;
    return file;
  }
  index.views.resize(kNumViews);
  const auto directions = view_directions();
  for (std::size_t k = 0; k < index.views.size(); ++k) index.views[k].direction = directions[k];
  for_each_array(index, [&reader](auto& array) { reader.array(array); });
  if (!reader.finished() || !fits_together(file, points)) return damaged;
  return file;
}

Result<std::string> occupancy_bytes(const OccupancyGrid& grid) {
  if (grid.size.maxCoeff() > static_cast<int>(kMost)) {
    return Status(StatusCode::unsupported, "an occupancy grid of more than 65535 cells a side");
  }
  std::string bytes(kOccupancyMagic);
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
      if (bucket.rays == 0) continue;
      append(bytes, stored(bucket, corner_of(grid, cell.place), grid.cell));
    }
  }
  return bytes;
}

Result<OccupancyGrid> parse_occupancy(const std::string& bytes, const std::string& name) {
  if (std::string_view(bytes).substr(0, kOccupancyMagic.size()) != kOccupancyMagic) {
    return corrupt(name, " is not an occupancy grid");
  }
  ByteReader reader(std::string_view(bytes).substr(kOccupancyMagic.size()));
  if (const auto version = reader.next<std::uint32_t>(); version != kOccupancyVersion) {
    return corrupt(name, " has format version ", version, "; this program reads version ",
                   kOccupancyVersion, ": make the model again");
  }
  OccupancyGrid grid;
  reader.value(grid.low);
  reader.value(grid.cell);
  reader.value(grid.size);
  const auto count = reader.next<std::uint64_t>();
  const bool legal = reader.ok() && grid.cell > 0 && grid.low.allFinite() &&
                     grid.size.minCoeff() >= 0 && grid.size.maxCoeff() <= static_cast<int>(kMost);
  if (!legal || !read_cells(reader, count, grid)) return corrupt(name, " is damaged");
  return grid;
}

}  // namespace io
}  // namespace bpa
