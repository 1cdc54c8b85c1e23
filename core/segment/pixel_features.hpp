// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/segment/super_pixels.hpp"

namespace bpa::segment::detail {

/// What k-means compares. Normal and colour are scaled so that 1 is as far as one spacing; fourth
/// elements are 0, but position[3], which is 1 for a pixel that has a normal.
struct PixelFeature {
  Eigen::Vector4f position = Eigen::Vector4f::Zero();
  Eigen::Vector4f normal = Eigen::Vector4f::Zero();
  Eigen::Vector4f color = Eigen::Vector4f::Zero();

  bool valid() const { return position[3] > 0; }
};

using PixelFeatures = std::vector<PixelFeature>;

PixelFeatures pixel_features(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                             const SuperPixelOptions& options);

/// The squared reciprocal of one spacing at depth z, 1/m^2.
float inverse_spacing_squared(const SurfaceMap& map, const SuperPixelOptions& options, float z);

/// Squared, in spacings.
inline float distance(const PixelFeature& a, const PixelFeature& b, float inverse_squared) {
  const float position = (a.position - b.position).squaredNorm();
  const Eigen::Vector4f normal = a.normal - b.normal, color = a.color - b.color;
  return inverse_squared * position + (normal.cwiseAbs2() + color.cwiseAbs2()).sum();
}

/// k-means: the index of the centre that each pixel belongs to; -1 without a normal.
Image<std::int32_t> cluster(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const SuperPixelOptions& options);

/// Splits clusters at edges, joins what is too small, and numbers the segments in the order of
/// their first pixels.
Image<std::int32_t> connect(const SurfaceMap& map, const PixelFeatures& features,
                            const Image<float>& edges, const Image<std::int32_t>& clusters,
                            const SuperPixelOptions& options);

}  // namespace bpa::segment::detail
