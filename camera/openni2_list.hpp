// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.hpp"

namespace bpa::camera {

/// The OpenNI2 devices with their modes and what is wrong with each, and the depth sensors on USB
/// that OpenNI2 does not serve, as text for people. Opens each device for a moment. Fails when
/// OpenNI2 has no drivers.
Result<std::string> list_devices();

}  // namespace bpa::camera
