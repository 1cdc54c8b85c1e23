// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.hpp"

namespace bpa {

const char* to_string(StatusCode code) {
  switch (code) {
    case StatusCode::ok:
      return "ok";
    case StatusCode::invalid_argument:
      return "invalid_argument";
    case StatusCode::not_found:
      return "not_found";
    case StatusCode::corrupt:
      return "corrupt";
    case StatusCode::unavailable:
      return "unavailable";
    case StatusCode::busy:
      return "busy";
    case StatusCode::timeout:
      return "timeout";
    case StatusCode::unsupported:
      return "unsupported";
    case StatusCode::internal:
      return "internal";
  }
  return "unknown";
}

}  // namespace bpa
