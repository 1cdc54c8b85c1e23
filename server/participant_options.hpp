// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.hpp"
#include "idl/wire/participant.hpp"
#include "server/options.hpp"

namespace bpa::server {

/// The server's seat in DDS, from its settings and the environment. Throws a Failure.
wire::ParticipantOptions participant_options(const ServerOptions& options, LogHook log);

}  // namespace bpa::server
