// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/base/status.hpp"
#include "core/model/model_index.hpp"

// index.bin of a model's folder. Little-endian; "bpaindex", kIndexVersion as u32,
// then arrays in the order of for_each_array() in the source file: a u64 with the number of
// elements, then these. Whatever derive_index() computes is not in it.

namespace bpa::io {

std::string index_bytes(const ModelIndex& index, const std::vector<float>& normal_variance);

/// What index_bytes wrote. The index is null when it was written by another version of the program,
/// whose indices differ: it must then be computed again.
struct IndexFile {
  std::shared_ptr<ModelIndex> index;
  std::vector<float> normal_variance;
};

/// `points` is the size of the model's surface; fails with corrupt when something does not fit
/// together. `name` is for messages.
Result<IndexFile> parse_index(const std::string& bytes, std::size_t points,
                              const std::string& name);

}  // namespace bpa::io
