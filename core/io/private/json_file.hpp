// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/file_bytes.hpp"

// JSON without exceptions leaving a function; matrices, poses and cameras as JSON.

namespace bpa::io {

constexpr double kMillimetres = 1000;  ///< Of a metre; BOP's files are in millimetres.

}  // namespace bpa::io

/// A matrix as its values, row by row. More values than it has are ignored.
template <int kRows, int kCols>
struct nlohmann::adl_serializer<Eigen::Matrix<double, kRows, kCols>> {
  using Matrix = Eigen::Matrix<double, kRows, kCols>;

  static void to_json(json& out, const Matrix& matrix) {
    out = json::array();
    for (int i = 0; i < kRows * kCols; ++i) out.push_back(matrix(i / kCols, i % kCols));
  }
  static void from_json(const json& in, Matrix& matrix) {
    const auto values = in.get<std::array<double, kRows * kCols>>();
    for (int i = 0; i < kRows * kCols; ++i) {
      matrix(i / kCols, i % kCols) = values[i];
    }
  }
};

/// A pose as {"rotation_wxyz": [..4], "translation_m": [..3]}.
template <>
struct nlohmann::adl_serializer<bpa::Pose> {
  static void to_json(json& out, const bpa::Pose& pose) {
    out = {{"rotation_wxyz", bpa::to_wxyz(pose.rotation)}, {"translation_m", pose.translation}};
  }
  static void from_json(const json& in, bpa::Pose& pose) {
    // Not normalised again: what was written is what is read, to the last bit.
    const auto q = in.at("rotation_wxyz").get<Eigen::Vector4d>();
    pose.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    in.at("translation_m").get_to(pose.translation);
  }
};

namespace bpa::io {

using Json = nlohmann::json;

/// JSON as text. Names of files are bytes in any encoding: what is no UTF-8 is replaced.
inline std::string written(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// Fails with corrupt when the bytes of a file are not JSON or nested deeper than any file of this
/// project: copies of JSON take stack for each level.
inline Result<Json> parse_json(const std::string& path, const std::string& bytes) {
  constexpr int kDeepest = 64;
  bool shallow = true;
  const auto keep = [&shallow](int depth, Json::parse_event_t, Json&) {
    shallow = shallow && depth <= kDeepest;
    return shallow;
  };
  Json json = Json::parse(bytes, keep, false);
  if (!shallow) return corrupt(path, " is JSON of more than ", kDeepest, " levels");
  if (json.is_discarded()) return corrupt(path, " is truncated or not JSON");
  return json;
}

/// The same of a file, which may be not_found.
inline Result<Json> read_json(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  return bytes.ok() ? parse_json(path, *bytes) : bytes.status();
}

/// A whole number that T holds, also where it is written as 5.0; anything else is an error.
template <std::integral T>
T whole_number(const Json& json) {
  const auto exact = [](auto number) -> std::optional<T> {
    if (!std::in_range<T>(number)) return std::nullopt;
    return static_cast<T>(number);
  };
  std::optional<T> number;
  if (json.is_number_unsigned()) {
    number = exact(json.get<std::uint64_t>());
  } else if (json.is_number_integer()) {
    number = exact(json.get<std::int64_t>());
  } else if (const double real = json.get<double>();
             real == std::trunc(real) && std::abs(real) < 0x1p53) {
    number = exact(static_cast<std::int64_t>(real));
  }
  if (!number) throw std::out_of_range(json.dump() + " is not a whole number that fits");
  return *number;
}

/// The same of a key; `otherwise` without it.
template <std::integral T>
T whole_number(const Json& json, const char* key, T otherwise) {
  return json.contains(key) ? whole_number<T>(json.at(key)) : otherwise;
}

/// Runs body(), which reads values out of JSON and returns a Status or a Result; what is missing or
/// of the wrong type becomes a corrupt status that names the file.
auto with_json(const std::string& path, const auto& body) -> decltype(body()) {
  try {
    return body();
  } catch (const std::exception& error) {
    std::string text = error.what();  // "[json.exception.out_of_range.403] key 'x' not found"
    if (const std::size_t end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    return corrupt(path, " does not have the expected content: ", text);
  }
}

/// Reads a file and runs body(json) as with_json does.
auto read_json(const std::string& path, const auto& body) -> decltype(body(Json())) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() { return body(*json); });
}

/// The one camera that JSON holds, in any of the forms of read_camera(). `name` is for messages.
Result<CameraFile> camera_of(const Json& json, const std::string& name);

// One list of a struct's keys for both the reader and the writer of JSON. A source file declares
//
//   static void fields(auto& visit, io::Is<Struct> auto& value) {
//     visit("key", value.member);
//     visit("other", value.other_member, io::kOptional);
//   }
//
// in the struct's namespace. After that, JSON converts to and from Struct.

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
    using Value = std::remove_cvref_t<decltype(value)>;
    if (optional && !json.contains(key)) return;
    if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
      value = whole_number<Value>(json.at(key));
    } else {
      json.at(key).get_to(value);
    }
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
