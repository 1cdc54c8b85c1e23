// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/model_index_file.hpp"

#include <algorithm>
#include <string_view>

#include "core/io/private/byte_stream.hpp"

namespace bpa::io {
namespace {

constexpr std::string_view kMagic = "bpaindex";

// Calls visit(array) for every array of the file. `Index` is const when writing.
template <class Index, class Visit>
void for_each_array(Index& index, const Visit& visit) {
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
  constexpr int kMost = 4096;
  return fits && t.cell > 0 && t.size.minCoeff() >= 1 && t.size.maxCoeff() <= kMost &&
         static_cast<double>(t.nearest.size()) == t.size.cast<double>().prod();
}

}  // namespace

std::string index_bytes(const ModelIndex& index, const std::vector<float>& normal_variance) {
  std::string bytes(kMagic);
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
  const Status damaged(StatusCode::corrupt, name + " does not fit the surface beside it");
  if (std::string_view(bytes).substr(0, kMagic.size()) != kMagic) return damaged;
  ByteReader reader(std::string_view(bytes).substr(kMagic.size()));
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

}  // namespace bpa::io
