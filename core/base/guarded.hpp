// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <new>
#include <string>
#include <type_traits>

#include "core/base/failure.hpp"
#include "core/base/status.hpp"

// Where exceptions end: foreign input may exhaust memory or hit a bug, and may not end a process.
// Threads, callbacks of DDS and calls of the SDK run what handles such input in guarded().

namespace bpa {

/// The failure that stands for an exception: that of a Failure, `unavailable` without memory, else
/// `internal`. The message begins with `about`, such as "the search failed".
inline Status status_of(const std::string& about, const std::exception& error) {
  if (const auto* failure = dynamic_cast<const Failure*>(&error)) {
    return Status(failure->status().code, about + ": " + error.what());
  }
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    return Status(StatusCode::unavailable, about + ": no memory is left");
  }
  return Status(StatusCode::internal, about + ": " + error.what());
}

/// Runs `call`, which returns a Status, a Result or nothing, and returns what it returns: a Status
/// for nothing. What it throws becomes a failure as status_of() makes it.
template <class Call>
auto guarded(const char* about, Call&& call) {
  using Returned = decltype(call());
  using Outcome = std::conditional_t<std::is_void_v<Returned>, Status, Returned>;
  try {
    if constexpr (std::is_void_v<Returned>) {
      call();
      return Outcome();
    } else {
      return Outcome(call());
    }
  } catch (const std::exception& error) {
    return Outcome(status_of(about, error));
  } catch (...) {
    return Outcome(Status(StatusCode::internal, std::string(about) + ": unknown exception"));
  }
}

}  // namespace bpa
