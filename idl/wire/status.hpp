// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/base/status.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"

namespace bpa::wire {

/// The status that a peer sent; `internal` where its code is none of ours.
inline Status to_status(const bpa_msgs::Status& message) {
  if (message.code <= static_cast<std::uint8_t>(StatusCode::internal)) {
    return {static_cast<StatusCode>(message.code), message.message};
  }
  return {StatusCode::internal,
          "the server answered with code " + std::to_string(message.code) + ": " + message.message};
}

}  // namespace bpa::wire
