// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "idl/wire/cdr.hpp"
#include "tests/idl/wire/sequences.hpp"

namespace bpa::wire {

/// Gives every field of a message some value; sequences get up to three elements.
class Filler {
 public:
  explicit Filler(unsigned seed) : random_(seed) {}

  template <class T>
  void operator()(const char*, T& value, Bound bound = {}) {
    fill(value, bound);
  }

  template <class T>
  void fill(T& value, Bound bound = {}) {
    if constexpr (std::is_same_v<T, bool>) {
      value = random_() % 2 == 1;
    } else if constexpr (std::is_same_v<T, std::byte>) {
      value = static_cast<std::byte>(random_() & 0xffU);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = static_cast<T>(std::uniform_real_distribution<double>(0, 100)(random_));
    } else if constexpr (std::is_same_v<T, std::string>) {
      value.assign(random_() % 9, static_cast<char>('a' + random_() % 26));
    } else if constexpr (detail::is_vector<T>::value) {
      value.resize(bound.max != 0 ? random_() % (bound.max + 1) : random_() % 4);
      for (std::size_t i = 0; i < value.size(); ++i) {
        typename T::value_type element{};
        fill(element);
        value[i] = element;
      }
    } else if constexpr (detail::is_array<T>::value) {
      for (auto& element : value) fill(element);
    } else {
      T::fields(value, *this);
    }
  }

 private:
  std::mt19937 random_;
};

/// A message with some value in every field; the same for the same seed.
template <class T>
T filled(unsigned seed) {
  T message;
  Filler(seed).fill(message);
  return message;
}

}  // namespace bpa::wire
