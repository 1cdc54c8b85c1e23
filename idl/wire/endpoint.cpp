// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/endpoint.hpp"

#include <cstring>

namespace bpa::wire::detail {

MessageRef bytes_ref(const std::vector<std::uint8_t>& bytes) {
  using Bytes = std::vector<std::uint8_t>;
  return {&bytes, [](const void* message) { return static_cast<const Bytes*>(message)->size(); },
          [](const void* message, std::uint8_t* to, std::size_t capacity) -> std::size_t {
            const Bytes& from = *static_cast<const Bytes*>(message);
            if (from.empty() || from.size() > capacity) return 0;
            std::memcpy(to, from.data(), from.size());
            return from.size();
          }};
}

}  // namespace bpa::wire::detail
