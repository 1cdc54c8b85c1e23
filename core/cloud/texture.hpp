// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/cloud/image.hpp"
#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// How an image goes on beyond its borders.
enum class Wrap { repeat, mirror, clamp };

using RgbImage = Image<std::array<std::uint8_t, 3>>;

/// An image on a surface.
struct Texture {
  std::vector<RgbImage> levels;  ///< The image, then each half as large as the one before, to 1x1.
  std::array<Wrap, 2> wrap{};    ///< Along u and v.
};

/// `image` has at least one pixel.
std::shared_ptr<const Texture> make_texture(RgbImage image, const std::array<Wrap, 2>& wrap = {});

/// Whether the mesh has colours of vertices or textures.
bool has_colors(const TriangleMesh& mesh);

/// Leaves the colours of the vertices.
void clear_textures(TriangleMesh& mesh);

/// The colour of a mesh that has colours, rgb in [0, 255], at the point of a triangle with these
/// barycentric weights of its second and third corner. Of a texture it is the mean over about a
/// square of `side` metres.
Eigen::Vector3f color_at(const TriangleMesh& mesh, std::size_t triangle,
                         const Eigen::Vector2f& weights, float side);

}  // namespace bpa
