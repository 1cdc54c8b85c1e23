// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "idl/wire/cdr.hpp"
#include "tests/idl/wire/sequences.hpp"

// The fields of a message as its C++ struct has them, to be compared with its .idl.

namespace bpa::wire {

/// One field; the numbers are those of type_description_interfaces/msg/FieldType.
struct FieldDescription {
  std::string name;
  int type_id = 0;
  std::size_t capacity = 0;         ///< Of a fixed array or bounded sequence.
  std::size_t string_capacity = 0;  ///< Of a bounded string.
  std::string nested_type;          ///< "pkg/msg/Name" when it is a struct.
};

struct StructDescription {
  std::string type;  ///< "pkg/msg/Name".
  std::vector<FieldDescription> fields;
};

/// Visits the fields of a message and writes them down.
class Describer {
 public:
  explicit Describer(StructDescription* into) : into_(into) {}

  template <class T>
  void operator()(const char* name, const T&, Bound bound = {}) {
    FieldDescription field;
    field.name = name;
    constexpr int kArray = 48, kBoundedSequence = 96, kSequence = 144;
    if constexpr (detail::is_vector<T>::value) {
      element<typename T::value_type>(field, {});
      field.type_id += bound.max == 0 ? kSequence : kBoundedSequence;
      field.capacity = bound.max;
    } else if constexpr (detail::is_array<T>::value) {
      element<typename T::value_type>(field, {});
      field.type_id += kArray;
      field.capacity = std::tuple_size_v<T>;
    } else {
      element<T>(field, bound);
    }
    into_->fields.push_back(std::move(field));
  }

 private:
  template <class T>
  void element(FieldDescription& field, Bound bound) {
    if constexpr (detail::is_scalar_v<T>) {
      field.type_id = scalar_id<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      field.type_id = bound.max == 0 ? 17 : 21;
      field.string_capacity = bound.max;
    } else {
      field.type_id = 1;
      field.nested_type = T::kType;
    }
  }

  template <class T>
  static constexpr int scalar_id() {
    if constexpr (std::is_same_v<T, bool>) return 15;
    if constexpr (std::is_same_v<T, std::byte>) return 16;
    if constexpr (std::is_same_v<T, float>) return 10;
    if constexpr (std::is_same_v<T, double>) return 11;
    constexpr int kBySize[] = {0, 2, 4, 0, 6, 0, 0, 0, 8};
    return kBySize[sizeof(T)] + (std::is_unsigned_v<T> ? 1 : 0);
  }

  StructDescription* into_;
};

/// The description of a message, from its list of fields.
template <class T>
StructDescription describe() {
  StructDescription result;
  result.type = T::kType;
  const T value{};
  T::fields(value, Describer(&result));
  return result;
}

}  // namespace bpa::wire
