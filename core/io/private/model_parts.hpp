// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/status.hpp"
#include "core/io/file_bytes.hpp"
#include "core/model/model_index.hpp"
#include "core/model/occupancy_grid.hpp"

// The files of a model's folder. `name` is for messages. What cannot be parsed is corrupt.

namespace bpa::io {

/// What model.json says of another file of the folder.
struct FileRecord {
  std::size_t bytes = 0;
  std::string xxh64;  ///< xxh64() as 16 hexadecimal digits.
};

/// model.json.
struct ModelDescription {
  ModelSource model;                        ///< Without surface, index and occupancy grid.
  std::size_t points = 0;                   ///< Of the surface.
  std::map<std::string, FileRecord> files;  ///< By name.
};

std::string description_text(const ModelDescription& description);

/// Fails with not_found, or with corrupt: not JSON, without a field, or of another version.
Result<ModelDescription> read_description(const std::string& path);

/// index.bin, little-endian. The header: "bpaindex", kIndexVersion as u32, an IndexHeader. Then
/// arrays, aligned (append_aligned), the normal variances first. It lacks what derive_index()
/// computes. A file of another program version reads as null: compute again.
struct IndexFile {
  std::shared_ptr<ModelIndex> index;
  std::vector<float> normal_variance;
};

std::string index_bytes(const ModelIndex& index, const std::vector<float>& normal_variance);

/// `points` is the size of the model's surface, which the index must fit. The large arrays (point
/// pairs, views, distance transform) stay in the file's memory; the others are copied. All indices
/// are checked, so that detection need not: this reads the file once.
Result<IndexFile> parse_index(const MappedFile& file, std::size_t points, const std::string& name);

/// occupancy.bin, little-endian, packed. The header: "bpaoccup", version u32, corner of cell (0, 0,
/// 0) 3 f32, side of a cell f32, size 3 i32; cell count u64. Each cell in which a ray ended: place
/// 3 u16, which buckets have rays u8 (bit 0, bit 1), a StoredBucket for each of these. Fails with
/// unsupported when the grid has more than 65535 cells along an axis.
Result<std::string> occupancy_bytes(const OccupancyGrid& grid);

/// What occupancy_bytes wrote, exact to the units of StoredBucket.
Result<OccupancyGrid> parse_occupancy(std::string_view bytes, const std::string& name);

}  // namespace bpa::io
