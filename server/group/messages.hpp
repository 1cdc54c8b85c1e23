// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/base/status.hpp"
#include "core/detect/candidate.hpp"
#include "core/detect/contest.hpp"
#include "core/pipeline/model_searches.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "server/group/library.hpp"

// What the members of a group tell one another, to the last bit: the answer must not depend on
// where a model was searched.

namespace bpa::server::group {

/// The parts of BEGIN that all shares have.
wire::bpa_msgs::GroupStep begin_message(const Frame& frame, const DetectRequest& request,
                                        const DetectorOptions& options, const SearchFacts& facts,
                                        const SharedLibrary& library);

/// What a share of a search is about.
struct ShareTask {
  Frame frame;
  DetectRequest request;
  DetectorOptions options;
  SearchFacts facts;
  std::vector<std::shared_ptr<const ObjectModel>> models;
};

/// Fails as the detector would, with invalid_argument; also where an option is unknown: then the
/// front is of another version. plan_search() checks the facts.
Result<ShareTask> task_of(wire::bpa_msgs::GroupStep begin, const SharedLibrary& library);

wire::bpa_msgs::GroupClaim to_message(const detect::Claim& claim);
detect::Claim claim_from(const wire::bpa_msgs::GroupClaim& message);

wire::bpa_msgs::GroupCandidate to_message(const detect::Candidate& candidate);
/// `pixels` is the size of the reduced image. Fails with corrupt.
Result<detect::Candidate> candidate_from(wire::bpa_msgs::GroupCandidate message,
                                         const ObjectModel& model, std::size_t pixels);

/// Milliseconds, 0 where the deadline never passes; above 0 where it has passed.
double milliseconds_left(const Deadline& deadline);

}  // namespace bpa::server::group
