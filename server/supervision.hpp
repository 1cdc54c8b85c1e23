// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <memory>

#include "core/base/log.hpp"
#include "server/server.hpp"

namespace bpa::server {

/// The exit code of a server that hung.
inline constexpr int kExitHung = 3;

/// Serves until one of `signals` comes, which all threads block, then destroys the server; a second
/// signal ends the process at once. Tells systemd of all that (service_manager.hpp). A server that
/// hangs says so, answers who waits and ends the process with kExitHung within seconds.
void serve_until_signal(std::unique_ptr<Server> server, const sigset_t& signals,
                        const LogHook& hook);

}  // namespace bpa::server
