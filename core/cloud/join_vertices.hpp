// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// The vertices that differ, in their order, and the place of each vertex among them.
struct JoinedVertices {
  std::vector<std::uint32_t> kept, place;
};

/// `key(i)` is an array of the floats of vertex i that count.
template <class Key>
JoinedVertices join_vertices(std::size_t count, const Key& key) {
  const auto plain = [&key](std::uint32_t i) {
    auto numbers = key(i);
    for (float& number : numbers) number += 0.0f;  // -0 is 0
    return numbers;
  };
  const auto hash = [&plain](std::uint32_t i) {
    const auto numbers = plain(i);
    return std::hash<std::string_view>()(
        {reinterpret_cast<const char*>(numbers.data()), sizeof numbers});
  };
  const auto same = [&plain](std::uint32_t i, std::uint32_t j) { return plain(i) == plain(j); };
  std::unordered_map<std::uint32_t, std::uint32_t, decltype(hash), decltype(same)> seen(count, hash,
                                                                                        same);
  JoinedVertices joined;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [at, is_new] = seen.try_emplace(i, joined.kept.size());
    if (is_new) joined.kept.push_back(i);
    joined.place.push_back(at->second);
  }
  return joined;
}

/// Positions and triangles of a mesh, each position once.
inline TriangleMesh shape_of(const TriangleMesh& mesh) {
  const JoinedVertices joined = join_vertices(mesh.vertices.size(), [&mesh](std::uint32_t i) {
    const Eigen::Vector3f& v = mesh.vertices[i];
    return std::array{v.x(), v.y(), v.z()};
  });
  TriangleMesh shape;
  for (const std::uint32_t i : joined.kept) shape.vertices.push_back(mesh.vertices[i]);
  for (const auto& [a, b, c] : mesh.triangles) {
    shape.triangles.push_back({joined.place[a], joined.place[b], joined.place[c]});
  }
  return shape;
}

}  // namespace bpa
