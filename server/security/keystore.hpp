// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/security/permissions.hpp"

namespace bpa::server {

/// Makes a keystore as SROS 2 lays it out: an authority of its own, which signs an identity and the
/// permissions for each enclave in one DDS domain. Valid for ten years. Keys may be read by their
/// owner alone. Throws a Failure: unavailable when the folder is there already or cannot be made.
void make_keystore(const std::string& folder, const std::vector<Permissions>& enclaves, int domain);

}  // namespace bpa::server
