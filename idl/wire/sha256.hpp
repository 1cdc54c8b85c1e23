// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace bpa::wire {

/// SHA-256 (FIPS 180-4) of some bytes, as 64 lower-case hex digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace bpa::wire
