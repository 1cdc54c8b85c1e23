// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/cdr.hpp"

namespace bpa::wire {

bool read_cdr_header(const std::uint8_t* bytes, std::size_t size, bool* swap) {
  if (size < kCdrHeaderSize || bytes[0] != 0 || bytes[1] > 1) return false;
  *swap = bytes[1] == 0;  // this project runs on little-endian hosts
  return true;
}

}  // namespace bpa::wire
