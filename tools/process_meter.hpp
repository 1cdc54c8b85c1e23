// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

// What this process costs, as Linux counts it.

namespace bpa::cli {

/// CPU time of all threads so far, seconds.
double cpu_seconds();

/// Resident memory at its largest since the last reset, or since the start, in MB (10^6 bytes).
/// Mapped files count as far as they were read. None where the kernel does not say.
std::optional<double> peak_memory_mb();
/// Gives unused memory back and starts a new peak. False where the kernel does not allow it.
bool reset_peak_memory();

/// The processor's name; "unknown" where the kernel does not say.
std::string cpu_name();

}  // namespace bpa::cli
