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

RawDecode copy_bytes(std::function<void(std::vector<std::uint8_t>&&, const SampleMeta&)> callback) {
  return [callback = std::move(callback)](const std::uint8_t* bytes,
                                          std::size_t size) -> Result<Deliver> {
    auto copy = std::make_shared<std::vector<std::uint8_t>>(bytes, bytes + size);
    return Deliver([&callback, copy](const SampleMeta& meta) { callback(std::move(*copy), meta); });
  };
}

}  // namespace bpa::wire::detail
