// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace bpa {

/// An immutable array. It owns its elements, or they lie in memory that it keeps alive, such as a
/// mapped file. Copies share the elements.
template <class T>
class SharedArray {
 public:
  using value_type = T;

  SharedArray() = default;
  /// Owns the elements. Implicit: what was built becomes immutable.
  SharedArray(std::vector<T> elements)  // NOLINT(google-explicit-constructor)
      : SharedArray(std::make_shared<const std::vector<T>>(std::move(elements))) {}
  /// The elements stay where they are; `owner` keeps them alive.
  SharedArray(std::span<const T> elements, std::shared_ptr<const void> owner)
      : elements_(elements), owner_(std::move(owner)) {}

  std::size_t size() const { return elements_.size(); }
  bool empty() const { return elements_.empty(); }
  const T* data() const { return elements_.data(); }
  const T& operator[](std::size_t i) const { return elements_[i]; }
  const T& back() const { return elements_.back(); }
  auto begin() const { return elements_.begin(); }
  auto end() const { return elements_.end(); }

  friend bool operator==(const SharedArray& a, const SharedArray& b) {
    return std::ranges::equal(a, b);
  }

 private:
  explicit SharedArray(std::shared_ptr<const std::vector<T>> owner)
      : elements_(*owner), owner_(std::move(owner)) {}

  std::span<const T> elements_;
  std::shared_ptr<const void> owner_;
};

}  // namespace bpa
