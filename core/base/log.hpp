// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace bpa {

enum class LogLevel { debug, info, warning, error };

/// A place in the program's text, as std::source_location of C++20 names it.
struct SourceLocation {
  const char* file = "";
  const char* function = "";
  int line = 0;

  static constexpr SourceLocation current(const char* file = __builtin_FILE(),
                                          const char* function = __builtin_FUNCTION(),
                                          int line = __builtin_LINE()) {
    return {file, function, line};
  }
};

/// What is said, where in the program, and which peer caused it.
struct LogMessage {
  std::string_view text;
  SourceLocation location;
  std::string_view peer = {};  ///< Such as a DDS participant's id; empty: no peer.

  operator std::string_view() const { return text; }  // NOLINT: hooks may take the text alone
};

/// What a library calls instead of printing. Passed as an argument to what may have something to
/// say; an empty hook means silence. Must be callable from any thread.
using LogHook = std::function<void(LogLevel, const LogMessage&)>;

/// Calls the hook if there is one.
inline void log(const LogHook& hook, LogLevel level, std::string_view text,
                SourceLocation location = SourceLocation::current()) {
  if (hook) hook(level, {text, location});
}

/// The same hook for what `peer` causes.
inline LogHook hook_of_peer(LogHook hook, std::string peer) {
  return [hook = std::move(hook), peer = std::move(peer)](LogLevel level, LogMessage message) {
    message.peer = peer;
    if (hook) hook(level, message);
  };
}

}  // namespace bpa
