// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/pipeline/detector.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "server/group/library.hpp"

// What the members of a group tell one another, to the last bit. All that comes from another member
// is checked here: it fails with `corrupt` or `invalid_argument`, and its sender is used no more.

namespace bpa::server::group {

/// A task without a share: the models are missing, and the time.
wire::bpa_msgs::GroupTask task_message(const Frame& frame, const DetectRequest& request,
                                       const DetectorOptions& options,
                                       const SharedLibrary& library);

/// What a worker searches.
struct Task {
  Frame frame;
  DetectRequest request;
  Models models;
};

/// Of a library that has the task's digest.
Result<Task> task_from(wire::bpa_msgs::GroupTask message, const SharedLibrary& library);

/// "path=value" of each.
Result<DetectorOptions> options_from(const std::vector<std::string>& texts);

/// What a search found, into an answer that says whose it is.
void put_result(const SearchResult& found, wire::bpa_msgs::GroupAnswer& answer);
/// Where the status is a failure, this is. `pixels` is the size of the reduced image.
Result<SearchResult> result_from(wire::bpa_msgs::GroupAnswer message, const Models& models,
                                 std::size_t pixels);

wire::bpa_msgs::GroupCandidate to_message(const detect::Candidate& candidate);
Result<detect::Candidate> candidate_from(wire::bpa_msgs::GroupCandidate message,
                                         const ObjectModel& model, std::size_t pixels);

}  // namespace bpa::server::group
