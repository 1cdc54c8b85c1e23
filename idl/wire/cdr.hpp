// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/concat.hpp"
#include "core/base/status.hpp"
#include "idl/wire/field.hpp"

// Plain CDR (XCDR1), the encoding of every ROS 2 message. A header of 4 bytes tells the byte order.
// Then come the fields, each aligned to its size, counted from the end of that header.
//
// Writing is in the host's byte order (little-endian hosts only); reading takes both. A reader
// checks a length against the remaining bytes before it allocates: never more than the message
// could fill.

namespace bpa::wire {

inline constexpr std::size_t kCdrHeaderSize = 4;

namespace detail {

template <class T>
inline constexpr bool is_scalar_v = std::is_arithmetic_v<T> || std::is_same_v<T, std::byte>;

/// Types whose arrays are on the wire as they are in memory.
template <class T>
inline constexpr bool is_block_v = is_scalar_v<T> && !std::is_same_v<T, bool>;

}  // namespace detail

/// Writes fields into memory of fixed size, or only counts bytes when that memory is null.
class CdrWriter {
 public:
  CdrWriter(std::uint8_t* body, std::size_t capacity) : body_(body), capacity_(capacity) {}

  /// Bytes written or counted so far, without the CDR header.
  std::size_t size() const { return position_; }
  /// False once the memory was too small or a bound was broken.
  bool ok() const { return ok_; }

  template <class T>
  void operator()(const char*, const T& value, Bound bound = {}) {
    write(value, bound);
  }

  /// A scalar or a message.
  template <class T>
  void write(const T& value, Bound = {}) {
    if constexpr (detail::is_scalar_v<T>) {
      align(sizeof(T));
      block(&value, sizeof(T));
    } else {
      T::fields(value, *this);
    }
  }
  void write(const std::string& value, Bound bound = {}) {
    length(value.size() + 1, bound.max == 0 ? 0 : bound.max + 1);
    block(value.c_str(), value.size() + 1);
  }
  void write(const ByteView& value, Bound bound = {}) {
    length(value.size, bound.max);
    block(value.data, value.size);
  }
  template <class T>
  void write(const std::vector<T>& value, Bound bound = {}) {
    length(value.size(), bound.max);
    elements(value);
  }
  template <class T, std::size_t N>
  void write(const std::array<T, N>& value, Bound = {}) {
    elements(value);
  }

 private:
  void align(std::size_t to) {
    const std::size_t padding = (to - position_ % to) % to;
    static constexpr std::uint8_t kZeros[8] = {};
    block(kZeros, padding);
  }

  void length(std::size_t count, std::size_t max) {
    if ((max != 0 && count > max) || count > 0xffffffffU) ok_ = false;
    write(static_cast<std::uint32_t>(count));
  }

  template <class Sequence>
  void elements(const Sequence& sequence) {
    using T = typename Sequence::value_type;
    if constexpr (detail::is_block_v<T>) {
      if (sequence.empty()) return;
      align(sizeof(T));
      block(sequence.data(), sequence.size() * sizeof(T));
    } else {
      for (const T& element : sequence) write(element);
    }
  }

  void block(const void* from, std::size_t bytes) {
    if (body_ != nullptr && bytes != 0) {
      if (!ok_ || bytes > capacity_ - position_) {
        ok_ = false;
        return;
      }
      std::memcpy(body_ + position_, from, bytes);
    }
    position_ += bytes;
  }

  std::uint8_t* body_;
  std::size_t capacity_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

/// Reads fields from memory. After a failure every further read does nothing.
class CdrReader {
 public:
  /// `body` is what follows the CDR header; `swap` when it is in the other byte order.
  CdrReader(const std::uint8_t* body, std::size_t size, bool swap)
      : body_(body), size_(size), swap_(swap) {}

  bool ok() const { return error_ == nullptr; }
  /// `corrupt` with the type, the field and what is wrong with it; ok if nothing is.
  Status status(const char* type) const {
    if (ok()) return {};
    return corrupt(type, " field ", field_, ": ", error_);
  }
  /// Bytes not read yet.
  std::size_t left() const { return size_ - position_; }

  template <class T>
  void operator()(const char* name, T& value, Bound bound = {}) {
    if (!ok()) return;
    read(value, bound);
    if (!ok() && field_ == nullptr) field_ = name;
  }

  /// A scalar or a message.
  template <class T>
  void read(T& value, Bound = {}) {
    if (!ok()) return;
    if constexpr (std::is_same_v<T, bool>) {
      std::uint8_t byte = 0;
      read(byte);
      value = byte != 0;
    } else if constexpr (detail::is_scalar_v<T>) {
      if (align(sizeof(T)) && need(sizeof(T))) scalars(&value, 1);
    } else {
      T::fields(value, *this);
    }
  }
  void read(std::string& value, Bound bound = {}) {
    const std::uint32_t length = read_length(bound.max == 0 ? 0 : bound.max + 1, 1);
    if (!ok()) return;
    // Length 0 is not legal CDR, but some peers send it for an empty string.
    const char* text = reinterpret_cast<const char*>(body_ + position_);
    position_ += length;
    if (length != 0 && text[length - 1] != '\0') return fail("the string does not end in NUL");
    value.assign(text, length == 0 ? 0 : length - 1);
  }
  template <class T>
  void read(std::vector<T>& value, Bound bound = {}) {
    if (!ok()) return;
    value.clear();
    const std::uint32_t count = read_length(bound.max, detail::is_block_v<T> ? sizeof(T) : 1);
    if constexpr (detail::is_block_v<T>) {
      if (count == 0 || !align(sizeof(T)) || !need(count * sizeof(T))) return;
      if constexpr (sizeof(T) == 1) {
        const T* from = reinterpret_cast<const T*>(body_ + position_);
        value.assign(from, from + count);  // unlike resize, does not write the memory twice
        position_ += count;
      } else {
        value.resize(count);
        scalars(value.data(), count);
      }
    } else {
      // Grows as the elements come: what a length claims is not believed before they are there.
      for (std::uint32_t i = 0; i < count && ok(); ++i) {
        T element{};
        read(element);
        value.push_back(std::move(element));
      }
    }
  }
  template <class T, std::size_t N>
  void read(std::array<T, N>& value, Bound = {}) {
    if constexpr (detail::is_block_v<T>) {
      if (ok() && align(sizeof(T)) && need(N * sizeof(T))) scalars(value.data(), N);
    } else {
      for (T& element : value) read(element);
    }
  }

 private:
  void fail(const char* why) {
    if (error_ == nullptr) error_ = why;
  }

  bool need(std::size_t bytes) {
    if (bytes > left()) fail("it is cut short");
    return ok();
  }

  bool align(std::size_t to) {
    const std::size_t padding = (to - position_ % to) % to;
    if (!need(padding)) return false;
    position_ += padding;
    return true;
  }

  /// The caller has checked that the bytes are there.
  template <class T>
  void scalars(T* to, std::size_t count) {
    std::memcpy(to, body_ + position_, count * sizeof(T));
    position_ += count * sizeof(T);
    if constexpr (sizeof(T) > 1) {
      if (swap_) {
        for (std::size_t i = 0; i < count; ++i) swap_bytes(to[i]);
      }
    }
  }

  template <class T>
  static void swap_bytes(T& value) {
    std::uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    std::reverse(bytes, bytes + sizeof(T));
    std::memcpy(&value, bytes, sizeof(T));
  }

  /// A count of elements of at least `least_bytes` each; 0 after a failure.
  std::uint32_t read_length(std::size_t max, std::size_t least_bytes) {
    std::uint32_t count = 0;
    read(count);
    if (max != 0 && count > max) fail("it is longer than its bound");
    if (count > left() / least_bytes) fail("its length is more than the message holds");
    return ok() ? count : 0;
  }

  const std::uint8_t* body_;
  std::size_t size_;
  std::size_t position_ = 0;
  bool swap_;
  const char* error_ = nullptr;
  const char* field_ = nullptr;
};

/// Bytes that `encode` will write, the CDR header included.
template <class T>
std::size_t encoded_size(const T& message) {
  CdrWriter counter(nullptr, 0);
  counter.write(message);
  return kCdrHeaderSize + counter.size();
}

/// Writes header and body into `to`; the bytes written, or 0 when `capacity` is too small or the
/// message breaks one of its own bounds.
template <class T>
std::size_t encode(const T& message, std::uint8_t* to, std::size_t capacity) {
  if (capacity < kCdrHeaderSize) return 0;
  const std::uint8_t header[kCdrHeaderSize] = {0, 1, 0, 0};
  std::memcpy(to, header, kCdrHeaderSize);
  CdrWriter writer(to + kCdrHeaderSize, capacity - kCdrHeaderSize);
  writer.write(message);
  return writer.ok() ? kCdrHeaderSize + writer.size() : 0;
}

/// The same into memory of its own; empty when the message breaks one of its own bounds.
template <class T>
std::vector<std::uint8_t> encode(const T& message) {
  std::vector<std::uint8_t> bytes(encoded_size(message));
  bytes.resize(encode(message, bytes.data(), bytes.size()));
  return bytes;
}

/// Whether the header is one of plain CDR; sets whether the body is in the other byte order.
inline bool read_cdr_header(const std::uint8_t* bytes, std::size_t size, bool* swap) {
  if (size < kCdrHeaderSize || bytes[0] != 0 || bytes[1] > 1) return false;
  *swap = bytes[1] == 0;  // this project runs on little-endian hosts
  return true;
}

/// Reads a message with its header. Bytes after the last field are ignored (peers pad).
/// `corrupt` names the message, the field and what is wrong; `message` is then half-filled.
template <class T>
Status decode(const std::uint8_t* bytes, std::size_t size, T& message) {
  bool swap = false;
  if (!read_cdr_header(bytes, size, &swap)) {
    return corrupt(T::kType, ": not plain CDR");
  }
  CdrReader reader(bytes + kCdrHeaderSize, size - kCdrHeaderSize, swap);
  reader.read(message);
  return reader.status(T::kType);
}

}  // namespace bpa::wire
