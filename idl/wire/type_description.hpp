// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "idl/wire/cdr.hpp"
#include "idl/wire/field.hpp"

// What REP 2011 calls the description of a type, and its hash RIHS01_<64 hex digits>, which ROS 2
// peers from Iron on show and which they miss with a warning when it is not announced.

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

struct TypeDescription {
  StructDescription type;
  std::vector<StructDescription> referenced;  ///< Every struct below it, sorted by name.
};

/// "RIHS01_" and the SHA-256 of the description's canonical JSON.
std::string type_hash(const TypeDescription& description);

namespace detail {

/// Visits the fields of a message and writes them down.
class Describer {
 public:
  Describer(StructDescription* into, std::vector<StructDescription>* referenced)
      : into_(into), referenced_(referenced) {}

  template <class T>
  void operator()(const char* name, const T&, Bound bound = {}) {
    FieldDescription field;
    field.name = name;
    constexpr int kArray = 48, kBoundedSequence = 96, kSequence = 144;
    if constexpr (std::is_same_v<T, ByteView>) {
      element<std::uint8_t>(field, {});
      field.type_id += kSequence;
    } else if constexpr (is_vector<T>::value) {
      element<typename T::value_type>(field, {});
      field.type_id += bound.max == 0 ? kSequence : kBoundedSequence;
      field.capacity = bound.max;
    } else if constexpr (is_array<T>::value) {
      element<typename T::value_type>(field, {});
      field.type_id += kArray;
      field.capacity = std::tuple_size_v<T>;
    } else {
      element<T>(field, bound);
    }
    into_->fields.push_back(std::move(field));
  }

  /// Adds T to the referenced structs, once, and all it refers to.
  template <class T>
  void refer() {
    for (const StructDescription& known : *referenced_) {
      if (known.type == T::kType) return;
    }
    StructDescription description;
    description.type = T::kType;
    const T value{};
    T::fields(value, Describer(&description, referenced_));
    referenced_->push_back(std::move(description));
  }

 private:
  template <class T>
  void element(FieldDescription& field, Bound bound) {
    if constexpr (is_scalar_v<T>) {
      field.type_id = scalar_id<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      field.type_id = bound.max == 0 ? 17 : 21;
      field.string_capacity = bound.max;
    } else {
      field.type_id = 1;
      field.nested_type = T::kType;
      refer<T>();
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
  std::vector<StructDescription>* referenced_;
};

void sort_by_name(std::vector<StructDescription>& structs);

}  // namespace detail

/// The description of a message, from its list of fields.
template <class T>
TypeDescription describe() {
  TypeDescription result;
  result.type.type = T::kType;
  const T value{};
  T::fields(value, detail::Describer(&result.type, &result.referenced));
  detail::sort_by_name(result.referenced);
  return result;
}

}  // namespace bpa::wire
