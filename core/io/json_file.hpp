// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/status.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/file_bytes.hpp"

// Private to io: JSON without exceptions leaving a function.

namespace bpa::io {

using Json = nlohmann::json;

/// Fails with not_found, or with corrupt when the file is not JSON.
inline Result<Json> read_json(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  Json json = Json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) {
    return Status(StatusCode::corrupt, path + " is truncated or not JSON");
  }
  return json;
}

/// Runs body(), which reads values out of JSON and returns a Status or a Result; what is missing or
/// of the wrong type becomes a corrupt status that names the file.
template <class Body>
auto with_json(const std::string& path, const Body& body) -> decltype(body()) {
  try {
    return body();
  } catch (const nlohmann::json::exception& error) {
    const std::string text = error.what();  // "[json.exception.out_of_range.403] key 'x' not found"
    const std::size_t end = text.find("] ");
    return Status(StatusCode::corrupt,
                  path + " does not have the expected content: " +
                      (end == std::string::npos ? text : text.substr(end + 2)));
  } catch (const std::exception& error) {
    return Status(StatusCode::corrupt,
                  path + " does not have the expected content: " + error.what());
  }
}

/// A pose as {"rotation_wxyz": [..4], "translation_m": [..3]}.
inline Json pose_to_json(const Pose& pose) {
  const Eigen::Vector4d q = to_wxyz(pose.rotation);
  const Eigen::Vector3d& t = pose.translation;
  return {{"rotation_wxyz", {q[0], q[1], q[2], q[3]}}, {"translation_m", {t[0], t[1], t[2]}}};
}

inline Pose pose_from_json(const Json& json) {
  const auto q = json.at("rotation_wxyz").get<std::array<double, 4>>();
  const auto t = json.at("translation_m").get<std::array<double, 3>>();
  // Not normalised again: what was written is what is read, to the last bit.
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), {t[0], t[1], t[2]}};
}

}  // namespace bpa::io
