// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/base/status.hpp"
#include "core/model/object_model.hpp"

// model.json of a model's folder.

namespace bpa::io {

/// What model.json says of another file of the folder.
struct FileRecord {
  std::size_t bytes = 0;
  std::uint32_t crc32 = 0;
};

struct ModelDescription {
  ModelSource model;                        ///< Without surface, index and occupancy grid.
  std::size_t points = 0;                   ///< Of the surface.
  std::map<std::string, FileRecord> files;  ///< By name.
};

/// The text of model.json.
std::string description_text(const ModelDescription& description);

/// Fails with not_found, or with corrupt when the file is not JSON, lacks a field, or is of another
/// version.
Result<ModelDescription> read_description(const std::string& path);

}  // namespace bpa::io
