// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace bpa::server {

/// Sets the nice value of this thread, and so of those that it starts from now on: Linux has one
/// for each thread. False when the system refuses: only root may lower one.
inline bool set_niceness(int niceness) {
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  return setpriority(PRIO_PROCESS, thread, niceness) == 0;
}

}  // namespace bpa::server
