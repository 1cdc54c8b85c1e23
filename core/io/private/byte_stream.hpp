// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

// Little-endian values one after the other. Only arrays that are read in place have padding.

namespace bpa::io {

static_assert(std::endian::native == std::endian::little, "values are written as they are");

inline void append(std::string& bytes, const auto& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Arrays that are read in place begin at multiples of this in their file, so that any element is
/// aligned.
constexpr std::size_t kArrayAlignment = 16;

/// An array as its length (u64), zeros up to a multiple of kArrayAlignment, and its values.
template <class T>
void append_aligned(std::string& bytes, std::span<const T> values) {
  append(bytes, static_cast<std::uint64_t>(values.size()));
  bytes.append((kArrayAlignment - bytes.size() % kArrayAlignment) % kArrayAlignment, '\0');
  if (values.empty()) return;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

/// Reads what append() wrote. A read past the end gives nothing; from then on ok() is false.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : start_(bytes.data()), bytes_(bytes) {}

  /// Whether the next bytes are these; moves past them.
  bool skip(std::string_view magic) {
    ok_ = ok_ && bytes_.starts_with(magic);
    if (ok_) bytes_.remove_prefix(magic.size());
    return ok_;
  }
  /// Leaves `out` as it is past the end.
  void value(auto& out) { copy(&out, 1); }
  /// The next number; 0 past the end.
  template <class T>
  T next() {
    T number = 0;
    copy(&number, 1);
    return number;
  }
  /// What append_aligned() wrote, in place: the bytes must outlive it. Their beginning must be
  /// aligned as the file's is; else, and past the end, it is empty.
  template <class T>
  std::span<const T> aligned() {
    const auto count = next<std::uint64_t>();
    const std::size_t at = bytes_.data() - start_;
    const std::size_t padding = (kArrayAlignment - at % kArrayAlignment) % kArrayAlignment;
    ok_ = ok_ && padding <= bytes_.size();
    if (!ok_) return {};
    bytes_.remove_prefix(padding);
    const char* data = bytes_.data();
    ok_ = count <= bytes_.size() / sizeof(T) &&
          reinterpret_cast<std::uintptr_t>(data) % alignof(T) == 0;
    if (!ok_) return {};
    bytes_.remove_prefix(count * sizeof(T));
    return {reinterpret_cast<const T*>(data), count};
  }
  std::size_t left() const { return bytes_.size(); }
  bool ok() const { return ok_; }
  bool finished() const { return ok_ && bytes_.empty(); }

 private:
  template <class T>
  void copy(T* out, std::size_t count) {
    const std::size_t size = count * sizeof(T);
    ok_ = ok_ && size <= bytes_.size();
    if (!ok_ || size == 0) return;
    std::memcpy(static_cast<void*>(out), bytes_.data(), size);
    bytes_.remove_prefix(size);
  }

  const char* start_;
  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace bpa::io
