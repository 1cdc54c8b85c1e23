// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"

// Which of a group's fronts serves clients. Every front says five times a second that it is there,
// how strong it is and whether it serves. ROS 2 subscribers cannot ask for DDS's exclusive
// ownership of the topics of results, so fronts decide by the same rule among themselves.

namespace bpa::server::group {

/// What a front says of itself.
struct FrontClaim {
  std::uint64_t front = 0;  ///< A random number for each start.
  std::string name;
  int strength = 0;
  bool serves = false;
};

/// Whether `own` is to serve beside those that are there: the strongest does. Of equals one that
/// serves goes on, else the smallest number begins. A weaker one serves until the stronger does.
bool is_to_serve(const FrontClaim& own, const std::vector<FrontClaim>& others);

/// One front's part in that, from create() until it is destroyed.
class Claims {
 public:
  /// `unavailable` when DDS cannot start. The participant outlives it.
  static Result<std::unique_ptr<Claims>> create(const wire::Participant& participant,
                                                const std::string& group, const std::string& name,
                                                int strength, LogHook log);
  virtual ~Claims() = default;

  /// Whether this front is to serve now. False for the first second, in which it listens.
  virtual bool is_to_serve() const = 0;
  /// Says to the others whether it does.
  virtual void set_serves(bool serves) = 0;
};

}  // namespace bpa::server::group
