// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "core/io/private/json_file.hpp"

// One list of a struct's keys for both the reader and the writer of JSON. A source file declares
//
//   static void fields(auto& visit, io::Is<Struct> auto& value) {
//     visit("key", value.member);
//     visit("other", value.other_member, io::kOptional);
//   }
//
// in the struct's namespace. After that, JSON converts to and from Struct.

namespace bpa::io {

/// A field that keeps its value where its key is missing; any other missing key is an error.
constexpr bool kOptional = true;

struct JsonWriter {
  Json& json;

  void operator()(const char* key, const auto& value, bool = false) { json[key] = value; }
  /// An object of its own; body(visit) visits its fields.
  void group(const char* key, const auto& body) { body(JsonWriter{json[key]}); }
};

struct JsonReader {
  const Json& json;

  void operator()(const char* key, auto& value, bool optional = false) {
    if (!optional || json.contains(key)) json.at(key).get_to(value);
  }
  void group(const char* key, const auto& body) { body(JsonReader{json.at(key)}); }
  bool has(const char* key) const { return json.contains(key); }
};

/// T is U or const U.
template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

template <class T>
concept HasFields = requires(JsonWriter& writer, const T& value) {
  fields(writer, value);
};

}  // namespace bpa::io

template <bpa::io::HasFields T>
struct nlohmann::adl_serializer<T> {
  static void to_json(json& out, const T& value) {
    bpa::io::JsonWriter writer{out};
    fields(writer, value);
  }
  static void from_json(const json& in, T& value) {
    bpa::io::JsonReader reader{in};
    fields(reader, value);
  }
};
