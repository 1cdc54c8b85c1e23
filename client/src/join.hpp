// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bpa/client.hpp>

#include "idl/wire/participant.hpp"

namespace bpa::sdk {

/// The seat of a client: its node is NAMESPACE/client. Fails as Client::connect() does, but waits
/// for no server.
Result<wire::Participant> join(const ClientOptions& options);

}  // namespace bpa::sdk
