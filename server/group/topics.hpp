// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/base/concat.hpp"
#include "idl/wire/qos.hpp"

// The topics of a group, below the server's namespace.

namespace bpa::server::group {

struct Topics {
  explicit Topics(const std::string& group) : prefix("group/" + group + "/") {}

  std::string prefix;

  std::string fronts() const { return prefix + "fronts"; }               ///< GroupFront
  std::string library() const { return prefix + "library"; }             ///< GroupLibrary
  std::string workers() const { return prefix + "workers"; }             ///< GroupWorker
  std::string answers() const { return prefix + "answers"; }             ///< GroupAnswer
  std::string model_files() const { return prefix + "get_model_file"; }  ///< GetModelFile
  /// GroupTask, of one worker.
  std::string tasks(std::uint64_t worker) const {
    return prefix + format("worker_%016llx", static_cast<unsigned long long>(worker)) + "/tasks";
  }
};

inline wire::Qos qos() {
  return {wire::Reliability::reliable, wire::Durability::volatile_, 200, 0};
}

}  // namespace bpa::server::group
