// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/recognition.hpp"
#include "server/server.hpp"

// The other roles of bpa-server (group.role), run and ended as a Server is.

namespace bpa::server {

/// Searches for the group's front, and offers nothing to clients. Throws a Failure.
std::unique_ptr<Server> make_worker(const ServerOptions& options, const LogHook& log);

/// A server of the options while it is the strongest front of its group; else it waits. Throws a
/// Failure.
std::unique_ptr<Server> make_front(const ServerOptions& options,
                                   std::shared_ptr<Recognition> recognition, const LogHook& log);

}  // namespace bpa::server
