// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "core/base/status.hpp"

// How the programs bpa, bpa-client and bpa-server fail: by an exception, which main() prints as one
// line. The rooms that they call return a Status or a Result; or_throw() stands between the two.

namespace bpa {

/// What a program could not do.
class Failure : public std::exception {
 public:
  explicit Failure(Status status) : status_(std::move(status)) {}

  const Status& status() const { return status_; }
  const char* what() const noexcept override { return status_.message.c_str(); }

 private:
  Status status_;
};

/// Throws a Failure unless the status is ok; the message begins with `about`, if given.
inline void or_throw(Status status, const std::string& about = "") {
  if (status.ok()) return;
  if (!about.empty()) status.message.insert(0, about + ": ");
  throw Failure(std::move(status));
}

/// The same for a result, whose value it returns.
template <class T>
T or_throw(Result<T> result, const std::string& about = "") {
  or_throw(result.status(), about);
  return std::move(result).value();
}

}  // namespace bpa
