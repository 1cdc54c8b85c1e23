// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/doctor/finding.hpp"

namespace bpa {

/// What DDS needs of a Linux machine.
struct MachineNeeds {
  std::string root;               ///< Goes before /dev/shm, /proc and /sys; empty: the machine.
  int domain = 0;                 ///< DDS domain.
  bool multicast = false;         ///< Whether peers are to be found by multicast.
  std::uint64_t shm_bytes = 0;    ///< Free room in /dev/shm; 0: any.
  std::uint64_t image_bytes = 0;  ///< Largest message that a socket must hold; 0: any.
  /// Less memory than this in the files of processes that have ended is no matter.
  std::uint64_t leftover_bytes = 16U << 20U;
};

/// What is wrong with the machine. What cannot be read gives no finding.
Findings check_machine(const MachineNeeds& needs);

}  // namespace bpa
