// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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

/// Counts instructions of this thread and of those that it starts, outside the kernel.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// Since the construction; none where kernel or machine does not allow it.
  std::optional<std::uint64_t> count() const;

 private:
  int file_;
};

}  // namespace bpa::cli
