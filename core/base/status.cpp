// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.hpp"

#include <iterator>

namespace bpa {

const char* to_string(StatusCode code) {
  constexpr const char* kNames[] = {"ok",      "invalid_argument", "not_found",
                                    "corrupt", "unavailable",      "busy",
                                    "timeout", "unsupported",      "internal"};
  const auto k = static_cast<std::size_t>(code);
  return k < std::size(kNames) ? kNames[k] : "unknown";
}

}  // namespace bpa
