// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/base/status.hpp"

namespace bpa::camera {

/// OpenNI2 with its drivers loaded, while this lives.
class Openni2Library {
 public:
  /// Fails when no driver can be loaded.
  static Result<std::shared_ptr<Openni2Library>> load();
  ~Openni2Library();
  Openni2Library(const Openni2Library&) = delete;
  Openni2Library& operator=(const Openni2Library&) = delete;

 private:
  Openni2Library() = default;
};

/// What OpenNI2 says about its last failure, in one line.
std::string openni2_error();

}  // namespace bpa::camera
