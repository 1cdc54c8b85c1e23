// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string_view>

namespace bpa {

enum class LogLevel { debug, info, warning, error };

/// What a library calls instead of printing. Passed as an argument to what may have something to
/// say; an empty hook means silence. Must be callable from any thread.
using LogHook = std::function<void(LogLevel, std::string_view message)>;

/// Calls the hook if there is one.
inline void log(const LogHook& hook, LogLevel level, std::string_view message) {
  if (hook) hook(level, message);
}

}  // namespace bpa
