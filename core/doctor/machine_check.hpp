// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/doctor/finding.hpp"

namespace bpa::doctor {

/// What DDS needs of a Linux machine.
struct MachineNeeds {
  std::string root;               ///< Goes before /proc and /sys; empty: the machine.
  int domain = 0;                 ///< DDS domain.
  bool multicast = false;         ///< Whether peers are to be found by multicast.
  std::uint64_t image_bytes = 0;  ///< Largest message that a socket must hold; 0: any.
};

/// What is wrong with the machine. What cannot be read gives no finding.
Findings check_machine(const MachineNeeds& needs);

}  // namespace bpa::doctor
