// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace bpa::cli {

/// Calls of operator new so far, by all threads. Only the program bpa has this function.
std::uint64_t count_allocations();

}  // namespace bpa::cli
