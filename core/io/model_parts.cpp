// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/model_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
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
  visit("xxh64", record.xxh64);
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
  return written(json, 1) + "\n";
}

Result<ModelDescription> read_description(const std::string& path) {
  return read_json(path, [&](const Json& json) -> Result<ModelDescription> {
    if (json.value("format", "") != kFormat) {
      return corrupt(path, " is not a model of this program");
    }
    const int version = whole_number<int>(json.at("version"));
    if (version == kModelFileVersion) return json.get<ModelDescription>();
    return corrupt(path, " has format version ", version, "; this program reads version ",
                   kModelFileVersion,
                   ": make the model again (bpa model from-mesh, from-bop or from-scans)");
  });
}

namespace {

constexpr std::string_view kIndexMagic = "bpaindex";

using Tables =
    std::array<features::PointPairTable::Arrays, 2>;     // `pairs` and `rim_pairs` of an index
using StoredPoses = std::vector<std::array<double, 7>>;  // rotation x y z w, translation

// Calls visit(number) for every number of the file. `index` is const when writing.
void for_each_number(auto& index, auto& tables, const auto& visit) {
  visit(index.distances.low);
  visit(index.distances.cell);
  visit(index.distances.size);
  visit(index.point_area);
  for (auto& table : tables) visit(table.inverse_step), visit(table.max_distance);
}

// Calls visit(array) for every array of the file but the normal variances.
void for_each_array(auto& index, auto& tables, auto& near_symmetries, const auto& visit) {
  visit(near_symmetries);
  visit(index.flat_rests);
  visit(index.soft_normals);
  visit(index.cielab);
  visit(index.log_light);
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
  visit(index.palette);
  for (auto& table : tables) {
    visit(table.first);
    visit(table.entries);
  }
}

StoredPoses stored(const std::vector<Pose>& poses) {
  StoredPoses out;
  for (const Pose& pose : poses) {
    const Eigen::Vector4d& q = pose.rotation.coeffs();
    const Eigen::Vector3d& t = pose.translation;
    out.push_back({q[0], q[1], q[2], q[3], t[0], t[1], t[2]});
  }
  return out;
}

std::vector<Pose> restored(const StoredPoses& poses) {
  std::vector<Pose> out;
  for (const auto& [x, y, z, w, a, b, c] : poses) {
    out.push_back({Eigen::Quaterniond(w, x, y, z), {a, b, c}});
  }
  return out;
}

// The loop ends late but is made of vector instructions.
bool below(const SharedArray<std::uint32_t>& indices, std::size_t limit) {
  std::uint32_t largest = 0;
  for (const std::uint32_t i : indices) largest = std::max(largest, i);
  return indices.empty() || largest < limit;
}

bool finite(const ModelIndex& index) {
  return std::isfinite(index.point_area) && index.distances.low.allFinite() &&
         std::ranges::all_of(index.near_symmetries,
                             [](const Pose& pose) {
                               return pose.rotation.coeffs().allFinite() &&
                                      pose.translation.allFinite();
                             }) &&
         std::ranges::all_of(index.flat_rests, [](const FlatRest& rest) {
           return rest.up.allFinite() && rest.axis.allFinite() && rest.centre.allFinite() &&
                  std::isfinite(rest.length) && std::isfinite(rest.width);
         });
}

bool fits_cloud(const PointCloud& cloud, bool curved) {
  const std::size_t n = cloud.size();
  return cloud.normals.size() == n && (cloud.colors.empty() || cloud.colors.size() == n) &&
         cloud.curvatures.size() == (curved ? n : 0) &&
         cloud.principal_directions.size() == (curved ? n : 0);
}

// Whatever the bytes were, nothing that reads the index may leave an array.
bool fits_together(const IndexFile& file, const Tables& tables, std::size_t points) {
  const ModelIndex& index = *file.index;
  bool fits = file.normal_variance.size() == points && index.soft_normals.size() == points &&
              fits_cloud(index.features, true) && fits_cloud(index.coarse, false) &&
              index.fpfh.size() == index.features.size() && below(index.distances.nearest, points);
  fits = fits && (index.cielab.empty() || index.cielab.size() == points) &&
         index.log_light.size() == index.cielab.size() &&
         index.palette.size() <= features::kAnyColor && finite(index);
  for (const features::PointPairTable::Arrays& table : tables)
    fits = fits && table.fit(index.coarse.size());
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

// Reads arrays: those of an index that are shared stay in the file's memory.
struct ArrayReader {
  ByteReader& reader;
  const std::shared_ptr<const void>& owner;

  template <class T>
  void operator()(std::vector<T>& out) const {
    const std::span<const T> values = reader.aligned<T>();
    out.assign(values.begin(), values.end());
  }
  template <class T>
  void operator()(SharedArray<T>& out) const {
    out = SharedArray<T>(reader.aligned<T>(), owner);
  }
};

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
  const Tables tables{index.pairs.arrays(), index.rim_pairs.arrays()};
  const StoredPoses near_symmetries = stored(index.near_symmetries);
  const auto append_one = [&bytes](const auto& array) {
    using Array = std::remove_cvref_t<decltype(array)>;
    append_aligned(bytes, std::span<const typename Array::value_type>(array));
  };
  append(bytes, static_cast<std::uint32_t>(kIndexVersion));
  append_one(normal_variance);
  for_each_number(index, tables, [&bytes](const auto& number) { append(bytes, number); });
  for_each_array(index, tables, near_symmetries, append_one);
  return bytes;
}

Result<IndexFile> parse_index(const MappedFile& mapped, std::size_t points,
                              const std::string& name) {
  const Status damaged = corrupt(name, " does not fit the surface beside it");
  ByteReader reader(mapped.bytes);
  if (!reader.skip(kIndexMagic)) return damaged;
  const auto version = reader.next<std::uint32_t>();
  IndexFile file;
  const ArrayReader read_array{reader, mapped.owner};
  read_array(file.normal_variance);
  if (version != kIndexVersion) {  // what follows may be anything
    if (file.normal_variance.size() != points) return damaged;
    return file;
  }
  file.index = std::make_shared<ModelIndex>();
  ModelIndex& index = *file.index;
  Tables tables;
  StoredPoses near_symmetries;
  index.views.resize(kNumViews);
  const auto directions = view_directions();
  for (std::size_t k = 0; k < index.views.size(); ++k) index.views[k].direction = directions[k];
  for_each_number(index, tables, [&reader](auto& number) { reader.value(number); });
  for_each_array(index, tables, near_symmetries, read_array);
  index.near_symmetries = restored(near_symmetries);
  if (!reader.finished() || !fits_together(file, tables, points)) return damaged;
  index.pairs = features::PointPairTable(std::move(tables[0]));
  index.rim_pairs = features::PointPairTable(std::move(tables[1]));
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

Result<OccupancyGrid> parse_occupancy(std::string_view bytes, const std::string& name) {
  ByteReader reader(bytes);
  if (!reader.skip(kOccupancyMagic)) return corrupt(name, " is not an occupancy grid");
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
