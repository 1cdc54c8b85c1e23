// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/pipeline/detector.hpp"
#include "idl/wire/participant.hpp"
#include "server/group/library.hpp"
#include "server/recognition.hpp"

namespace bpa::server::group {

/// Gives the models of each search to workers, and brings their candidates together.
class Front {
 public:
  /// `unavailable` when DDS cannot start. The participant outlives it.
  static Result<std::unique_ptr<Front>> create(const wire::Participant& participant,
                                               const std::string& group, LogHook log);
  virtual ~Front() = default;

  /// What is searched from now on. Workers fetch it; those that have not are not used.
  virtual void set_library(std::shared_ptr<const SharedLibrary> library) = 0;

  /// For Detector::detect() of one frame with a library that was set: the detector's own. The
  /// references outlive the search. `waiting` is how many more frames wait.
  virtual RemoteSearch search_for(std::shared_ptr<const SharedLibrary> library,
                                  const Detector& detector, const Frame& frame,
                                  const DetectRequest& request, std::size_t waiting) = 0;
  /// Workers that could search now.
  virtual std::size_t ready_workers() const = 0;
  virtual std::vector<WorkerState> workers() const = 0;
};

}  // namespace bpa::server::group
