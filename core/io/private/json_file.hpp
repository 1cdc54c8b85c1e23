// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <exception>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/geometry/camera.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/file_bytes.hpp"

// JSON without exceptions leaving a function; matrices, poses and cameras as JSON.

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

/// Fails with not_found, or with corrupt when the file is not JSON.
inline Result<Json> read_json(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  Json json = Json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return corrupt(path, " is truncated or not JSON");
  return json;
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

/// The camera of a BOP "cam_K", the 3 x 3 matrix of its intrinsics row by row, without a size.
inline Camera camera_of(const std::array<double, 9>& k) { return {0, 0, k[0], k[4], k[2], k[5]}; }

}  // namespace bpa::io
