// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/status.hpp"
#include "core/model/library.hpp"
#include "core/score/score_layer.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"

// What all members of a group search for: the same models in the same versions.

namespace bpa::server::group {

/// A library that a group searches.
struct SharedLibrary {
  wire::bpa_msgs::GroupLibrary offer;  ///< Its digest and those of its models.
  ModelLibrary models;
  score::ScoreLayers layers;
  std::map<std::string, std::string> folders;  ///< Of each model, by name.

  /// nullptr without one of that number.
  std::shared_ptr<const ObjectModel> find(int number) const;
};

/// The library as it is offered. `folders` are those that the models were read from, by name.
Result<std::shared_ptr<const SharedLibrary>> share_library(
    ModelLibrary models, score::ScoreLayers layers, std::map<std::string, std::string> folders);

/// Answers a worker that fetches a model.
wire::bpa_msgs::GetModelFile_Response read_model_file(
    const SharedLibrary& library, const wire::bpa_msgs::GetModelFile_Request& request);

/// Most bytes of a file in one answer.
constexpr std::uint32_t kMaxFilePart = 1048576;

/// Where a worker keeps the models that it has fetched: a folder of folders, one for each digest.
/// Several workers may share it.
class ModelCache {
 public:
  /// Gets one part of a file.
  using Fetch = std::function<Result<wire::bpa_msgs::GetModelFile_Response>(
      const wire::bpa_msgs::GetModelFile_Request&)>;

  /// The folder is made if it is missing.
  explicit ModelCache(std::string folder) : folder_(std::move(folder)) {}

  /// The folder that holds the model, fetched if it is not there. Fails as `fetch` does, with
  /// corrupt where what came is another version, or with unavailable where it cannot be written.
  Result<std::string> folder_of(const wire::bpa_msgs::GroupModel& model, const Fetch& fetch) const;

 private:
  std::string folder_;
};

/// Reads the models that were offered; those that `before` has in the same version are taken from
/// there.
Result<std::shared_ptr<const SharedLibrary>> load_library(const wire::bpa_msgs::GroupLibrary& offer,
                                                          const SharedLibrary* before,
                                                          const ModelCache& cache,
                                                          const ModelCache::Fetch& fetch,
                                                          int num_threads);

}  // namespace bpa::server::group
