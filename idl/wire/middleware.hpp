// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

namespace bpa::wire {

/// Variables of the environment by name; an empty value is as good as none.
using Environment = std::map<std::string, std::string>;

/// Which ROS 2 nodes a participant of ours does not reach, or which variable it does not obey.
struct MiddlewareNote {
  bool unreachable = false;  ///< Nodes of this environment are out of reach; else a doubt.
  std::string what;          ///< One clause. The same for the same trouble.
  std::string why;
  std::string remedy;  ///< What to do.
};

using MiddlewareNotes = std::vector<MiddlewareNote>;

/// fastdds_major: of the Fast DDS that we are built with, 2 or 3. zenoh_router: one listens on this
/// machine. None for an environment that is in order.
MiddlewareNotes check_middleware(const Environment& environment, int fastdds_major,
                                 bool zenoh_router);

/// The same of this process and this machine. range_from_environment: false where a setting says
/// how far discovery reaches, so that the environment does not.
MiddlewareNotes check_middleware(bool range_from_environment);

/// The note in one line, for a log.
std::string line_of(const MiddlewareNote& note);

}  // namespace bpa::wire
