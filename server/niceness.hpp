// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace bpa::server {

// Linux has a nice value for each thread. A thread that is started has that of its starter.

inline id_t own_thread() { return static_cast<id_t>(syscall(SYS_gettid)); }

/// Of this thread.
inline int niceness() { return getpriority(PRIO_PROCESS, own_thread()); }

/// Sets the nice value of this thread, and so of those that it starts from now on. False when the
/// system refuses: only root may lower one.
inline bool set_niceness(int niceness) {
  return setpriority(PRIO_PROCESS, own_thread(), niceness) == 0;
}

}  // namespace bpa::server
