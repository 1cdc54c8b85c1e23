// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"
#include "core/features/curvature_edges.hpp"
#include "core/features/image_edges.hpp"
#include "core/features/range_edges.hpp"

namespace bpa {

/// The defaults are chosen by hand; the paper gives no numbers.
struct EdgeImageOptions {
  double blur_px = 1.0;
  double range_weight = 1.0;
  double curvature_weight = 0.6;
  double image_weight = 0.3;
  RangeEdgeOptions range;
  ImageEdgeOptions image;
  CurvatureEdgeOptions curvature;
  int num_threads = 0;

  template <class Visitor>
  void visit_fields(Visitor&& visit) {
    visit("edge_blur_px", blur_px,
          FieldRule{0, 10, "Standard deviation of the edge image's blur, pixels."});
    visit("range_weight", range_weight, FieldRule{0, 10, "Weight of range edges."});
    visit("curvature_weight", curvature_weight, FieldRule{0, 10, "Weight of curvature edges."});
    visit("image_weight", image_weight, FieldRule{0, 10, "Weight of image edges."});
  }
};

/// The three kinds of edges of a frame and what they say together. All of the surface map's size.
struct SceneEdges {
  Image<RangeEdge> range;
  Image<std::uint8_t> image;      ///< 1 on an edge; all 0 without colour.
  Image<std::uint8_t> curvature;  ///< 1 on an edge.
  Image<float> likelihood;        ///< The edge image, in [0, 1].
};

/// The edge image (paper section V): the spatially blurred, weighted average of the three masks,
/// the relative likelihood that a pixel is on the boundary of an object. In units of the strongest
/// evidence: 1 (where it is cut off) on a straight line that is an edge of the kind of the largest
/// weight.
Image<float> edge_image(const Image<RangeEdge>& range, const Image<std::uint8_t>& image,
                        const Image<std::uint8_t>& curvature, const EdgeImageOptions& options = {});

/// All edges of a frame. `rgb` is its reduced_color, empty without colour.
SceneEdges scene_edges(const SurfaceMap& map, const Image<Eigen::Vector3f>& rgb,
                       const EdgeImageOptions& options = {});

}  // namespace bpa
