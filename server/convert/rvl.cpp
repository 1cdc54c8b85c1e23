// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "server/convert/images.hpp"

namespace bpa::server {
namespace {

/// Reads numbers of groups of four bits.
class Groups {
 public:
  Groups(const std::uint8_t* data, std::size_t size) : data_(data), left_(size / 4) {}

  bool ok() const { return ok_; }

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 3) {
      const std::uint32_t group = next();
      value |= (group & 7U) << static_cast<unsigned>(shift);
      if ((group & 8U) == 0) return value;
    }
    ok_ = false;  // more groups than a number has
    return 0;
  }

 private:
  std::uint32_t next() {
    if (in_word_ == 0) {
      if (left_ == 0) {
        ok_ = false;
        return 0;
      }
      std::memcpy(&word_, data_, 4);
      data_ += 4;
      --left_;
      in_word_ = 8;
    }
    const std::uint32_t group = word_ >> 28U;
    word_ <<= 4U;
    --in_word_;
    return group;
  }

  const std::uint8_t* data_;
  std::size_t left_;  ///< Words.
  std::uint32_t word_ = 0;
  int in_word_ = 0;
  bool ok_ = true;
};

}  // namespace

bool decode_rvl(const std::uint8_t* data, std::size_t size, std::size_t count,
                std::vector<std::uint16_t>& values) {
  values.clear();
  // A group is half a byte and two numbers of one group may stand for any run of zeros, so memory
  // is taken for what the caller's size says.
  values.reserve(count);
  Groups groups(data, size);
  std::uint32_t last = 0;
  while (values.size() < count) {
    const std::uint32_t zeros = groups.number();
    const std::uint32_t others = groups.number();
    const std::size_t left = count - values.size();
    if (!groups.ok() || zeros > left || others > left - zeros || zeros + others == 0) return false;
    values.insert(values.end(), zeros, std::uint16_t{0});
    for (std::uint32_t i = 0; i < others; ++i) {
      const std::uint32_t zigzag = groups.number();
      if (!groups.ok()) return false;
      last += (zigzag >> 1U) ^ (~(zigzag & 1U) + 1U);
      values.push_back(static_cast<std::uint16_t>(last));
    }
  }
  return true;
}

}  // namespace bpa::server
