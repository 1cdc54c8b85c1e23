// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.hpp"

namespace bpa::wire::detail {

/// Takes Fast DDS's own messages, which it would print, to a hook: its errors as warnings, its
/// warnings as debug. Fast DDS has one log a process; the hook of the last participant gets it.
void bridge_log(const LogHook& hook);

}  // namespace bpa::wire::detail
