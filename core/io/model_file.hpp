// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/model/object_model.hpp"

// A library on disk is a folder of folders, one for each model:
//
//   LIBRARY/NAME/model.json     its description; size and checksum of the other files
//   LIBRARY/NAME/surface.ply    its surface: binary; points, normals, colours; metres
//   LIBRARY/NAME/index.bin      what was computed from it, so that loading is quick; mapped into
//                               memory, so never write into it: replace the model
//   LIBRARY/NAME/occupancy.bin  its occupancy grid, if it was made from views

namespace bpa::io {

constexpr int kModelFileVersion = 4;

/// Writes a model into a library, replacing one of the same name. The old model stays whole until
/// the new one is. Computes the index unless model.prepared has it. The name has letters, digits,
/// '_', '-' and '.' (not first). The number is positive and not another model's. Fails with
/// invalid_argument on other names and numbers and on too small a surface; unavailable when it
/// cannot be written.
Status save_model(const std::string& library, const ModelSource& model, int num_threads = 0);

/// Reads LIBRARY/NAME without the occupancy grid, whose file is only checked. `prepared` is the
/// stored index. Fails with not_found, or with corrupt saying whether the file is truncated,
/// altered (its checksum differs), or of another version.
Result<ModelSource> load_model(const std::string& library, const std::string& name);

/// The occupancy grid of LIBRARY/NAME, exact to 1/65535 of a cell; null when the model was made
/// without views. Fails as load_model does.
Result<std::shared_ptr<const OccupancyGrid>> load_occupancy(const std::string& library,
                                                            const std::string& name);

/// The same as load_model without surface and index, which are not read.
Result<ModelSource> describe_model(const std::string& library, const std::string& name);

/// A model that cannot be read, and why.
struct BrokenModel {
  std::string name;
  Status reason;
};

/// What a library holds.
struct LibraryContents {
  std::vector<ModelSource> models;  ///< By increasing number.
  /// By name: models that load_model refuses, and those with a number that another has.
  std::vector<BrokenModel> broken;
};

/// Every model of a library, read in parallel: one that is broken costs no other. Fails with
/// not_found when the folder is not there.
Result<LibraryContents> read_library(const std::string& library, int num_threads = 0);

/// One line that says which models of a library cannot be read, and why; ok when all can be.
Status explain_broken(const std::string& library, const std::vector<BrokenModel>& broken);

/// The models of a library, if none is broken. Fails with not_found (no such folder),
/// invalid_argument (no model in it) or corrupt (a broken model).
Result<std::vector<ModelSource>> load_library(const std::string& library, int num_threads = 0);

/// The names of a library's models, sorted by name; empty for an empty or missing folder.
std::vector<std::string> list_models(const std::string& library);

/// Fails with not_found.
Status remove_model(const std::string& library, const std::string& name);

/// A name that save_model accepts: other characters become '_'.
std::string clean_model_name(const std::string& name);

}  // namespace bpa::io
