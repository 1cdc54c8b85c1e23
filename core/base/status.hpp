// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <utility>

// The one way to report that something could not be done. C++17: the client SDK shows these types.
//
// Three kinds of trouble: a caller's bug is an assert; bad input, a bad file or a bad message is a
// Status; finding nothing is an empty result, not an error.

namespace bpa {

enum class StatusCode {
  ok,
  invalid_argument,  ///< The caller's input breaks a stated rule.
  not_found,         ///< A file, model or topic that was named does not exist.
  corrupt,           ///< A file or message is truncated, altered or of another version.
  unavailable,       ///< The peer or device is not there now; trying again may help.
  busy,              ///< The server's queue is full; trying again later may help.
  timeout,           ///< The answer did not come in the time allowed.
  unsupported,       ///< Legal, but not handled by this program.
  internal,          ///< A bug in this program.
};

/// The lower-case name of a code, such as "invalid_argument".
const char* to_string(StatusCode code);

/// A code and one sentence that says what was wrong and what is right.
struct [[nodiscard]] Status {
  StatusCode code = StatusCode::ok;
  std::string message;

  Status() = default;
  Status(StatusCode status_code, std::string text) : code(status_code), message(std::move(text)) {}

  bool ok() const { return code == StatusCode::ok; }
};

/// Shorthand for the most common failure.
inline Status invalid_argument(std::string message) {
  return Status(StatusCode::invalid_argument, std::move(message));
}

/// Either a T or the Status that says why there is none.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}         // NOLINT: implicit on purpose
  Result(Status status) : status_(std::move(status)) {  // NOLINT: implicit on purpose
    assert(!status_.ok() && "a Result without a value needs a failure");
  }

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }

  /// The value; calling these when !ok() is a caller's bug.
  T& value() & {
    assert(ok());
    return *value_;
  }
  const T& value() const& {
    assert(ok());
    return *value_;
  }
  T&& value() && {
    assert(ok());
    return *std::move(value_);
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  Status status_;
  std::optional<T> value_;
};

}  // namespace bpa
