// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/texture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bpa {
namespace {

Eigen::Vector3f to_vector(const std::array<std::uint8_t, 3>& rgb) {
  return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

Eigen::Vector3f between(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float share) {
  return a + share * (b - a);
}

// The image at half its size; each pixel is the mean of the two, three or four that it covers.
RgbImage halved(const RgbImage& image) {
  RgbImage out(std::max(1, image.width / 2), std::max(1, image.height / 2), {});
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      float count = 0;
      for (int v = y * image.height / out.height; v < (y + 1) * image.height / out.height; ++v) {
        for (int u = x * image.width / out.width; u < (x + 1) * image.width / out.width; ++u) {
          sum += to_vector(image.at(u, v));
          ++count;
        }
      }
      for (int c = 0; c < 3; ++c) {
        out.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(sum[c] / count));
      }
    }
  }
  return out;
}

// Of a coordinate whose unit is the width or height of the image: where it is in [0, 1].
float wrapped(float x, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(x, 0.0f, 1.0f);
  if (wrap == Wrap::repeat) return x - std::floor(x);
  const float back_and_forth = x - 2 * std::floor(x / 2);
  return std::min(back_and_forth, 2 - back_and_forth);
}

// The two pixels beside a place in [0, 1] and the weight of the second.
struct Neighbors {
  int first, second;
  float weight;
};

Neighbors neighbors(float place, int size, Wrap wrap) {
  const float pixel = place * static_cast<float>(size) - 0.5f;
  const int first = static_cast<int>(std::floor(pixel));
  const auto inside = [&](int i) {
    return wrap == Wrap::repeat ? (i + size) % size : std::clamp(i, 0, size - 1);
  };
  return {inside(first), inside(first + 1), pixel - static_cast<float>(first)};
}

Eigen::Vector3f bilinear(const RgbImage& image, const Eigen::Vector2f& uv,
                         const std::array<Wrap, 2>& wrap) {
  const Neighbors x = neighbors(wrapped(uv.x(), wrap[0]), image.width, wrap[0]);
  const Neighbors y = neighbors(wrapped(1 - uv.y(), wrap[1]), image.height, wrap[1]);
  const auto row = [&](int v) {
    return between(to_vector(image.at(x.first, v)), to_vector(image.at(x.second, v)), x.weight);
  };
  return between(row(y.first), row(y.second), y.weight);
}

}  // namespace

std::shared_ptr<const Texture> make_texture(RgbImage image, const std::array<Wrap, 2>& wrap) {
  auto texture = std::make_shared<Texture>();
  texture->wrap = wrap;
  texture->levels.push_back(std::move(image));
  while (texture->levels.back().size() > 1) {
    texture->levels.push_back(halved(texture->levels.back()));
  }
  return texture;
}

bool has_colors(const TriangleMesh& mesh) { return !mesh.colors.empty() || !mesh.textures.empty(); }

void clear_textures(TriangleMesh& mesh) {
  mesh.textures.clear();
  mesh.texture_of.clear();
  mesh.uv.clear();
}

Eigen::Vector3f color_at(const TriangleMesh& mesh, std::size_t triangle,
                         const Eigen::Vector2f& weights, float side) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const int index = mesh.textures.empty() ? -1 : mesh.texture_of[triangle];
  if (index < 0) {
    const Eigen::Vector3f from = to_vector(mesh.colors[a]);
    return from + weights.x() * (to_vector(mesh.colors[b]) - from) +
           weights.y() * (to_vector(mesh.colors[c]) - from);
  }
  const Texture& texture = *mesh.textures[index];
  const RgbImage& image = texture.levels.front();
  const Eigen::Vector2f ab = mesh.uv[b] - mesh.uv[a], ac = mesh.uv[c] - mesh.uv[a];
  const float texels = std::abs(ab.x() * ac.y() - ab.y() * ac.x()) *
                       static_cast<float>(image.width) * static_cast<float>(image.height);
  const float area =
      (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm();
  const float across = side * std::sqrt(texels / std::max(area, 1e-12f));  // texels in `side`
  const auto last = static_cast<float>(texture.levels.size() - 1);
  const float level = std::clamp(std::round(std::log2(std::max(across, 1.0f))), 0.0f, last);
  // A triangle that stays in the image has nothing of its opposite border.
  std::array<Wrap, 2> wrap = texture.wrap;
  for (int k = 0; k < 2; ++k) {
    const auto [low, high] = std::minmax({mesh.uv[a][k], mesh.uv[b][k], mesh.uv[c][k]});
    if (low >= 0 && high <= 1) wrap[k] = Wrap::clamp;
  }
  return bilinear(texture.levels[static_cast<std::size_t>(level)],
                  mesh.uv[a] + weights.x() * ab + weights.y() * ac, wrap);
}

}  // namespace bpa
