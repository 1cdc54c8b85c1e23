// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa::features {

/// What a pixel is at a depth discontinuity.
enum class RangeEdge : std::uint8_t {
  none = 0,
  occluding = 1,  ///< On the nearer surface: something ends here.
  occluded = 2,   ///< On the further surface: something is hidden from here on.
};

/// The default is chosen by hand.
struct RangeEdgeOptions {
  BPA_OPTION(int, max_gap_px, 20, (0, 200), "Pixels without depth that an edge spans.");
  int num_threads = 0;  ///< 0: one for each core.
};

/// Depth discontinuities (paper, V.2) between each pixel and the next one with a depth, in the
/// grid's four directions. See surface_breaks() for the criterion. Sensors with a projector see
/// nothing beside an edge; the gap does not count, unless it is longer than max_gap_px.
Image<RangeEdge> range_edges(const SurfaceMap& map, const RangeEdgeOptions& options = {});

/// The defaults are chosen by hand.
struct ImageEdgeOptions {
  BPA_OPTION(double, blur_px, 0.8, (0, 10),
             "Standard deviation of the blur before gradients, pixels.");
  BPA_OPTION(double, low, 10, (0, 255), "Step of luminance (of 255) that continues an image edge.");
  BPA_OPTION(double, high, 25, (0, 255), "Step of luminance (of 255) that begins an image edge.");
  int num_threads = 0;  ///< 0: one for each core.
};

/// Intensity discontinuities of an rgb image in [0, 255], by Canny's detector: 1 on an edge, else
/// 0. All 0 for an empty image.
Image<std::uint8_t> image_edges(const Image<Eigen::Vector3f>& rgb,
                                const ImageEdgeOptions& options = {});

/// The defaults are chosen by hand.
struct CurvatureEdgeOptions {
  BPA_OPTION(double, baseline_m, 0.010, (0.001, 0.1),
             "Normals this far to either side are compared, metres.");
  BPA_OPTION(double, min_concavity, 30, (0, 1000),
             "Least concavity of an edge, 1 / radius of the hollow, per metre.");
  BPA_OPTION(double, max_baseline_px, 8, (1, 50), "Largest baseline in the image, pixels.");
  int num_threads = 0;  ///< 0: one for each core.
};

/// The lowest normal curvature among the four directions of the grid and its diagonals, per metre:
/// (n1 - n2) . (p1 - p2) / |p1 - p2|^2 over points p and normals n on either side. Negative where
/// the surface is hollow, -1/r in a trough of radius r, 1/r on a ball; 0 where it is not known, and
/// across range edges.
struct HollowMap {
  Image<float> curvature;
  Image<std::uint8_t> direction;  ///< 0..3: of the lowest, see kHollowDirections.
};
constexpr int kHollowDirections[4][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}};
HollowMap hollow_map(const SurfaceMap& map, const CurvatureEdgeOptions& options = {});

/// High negative curvature (paper, V.2), where objects touch. 1 along the bottom of a hollow, where
/// the lowest curvature is lower than on either side; else 0.
Image<std::uint8_t> curvature_edges(const SurfaceMap& map,
                                    const CurvatureEdgeOptions& options = {});

/// The defaults are chosen by hand; the paper gives no numbers.
struct EdgeImageOptions {
  BPA_NAMED_OPTION("edge_blur_px", double, blur_px, 1.0, (0, 10),
                   "Standard deviation of the edge image's blur, pixels.");
  double range_weight = 1.0;      ///< Weight of range edges.
  double curvature_weight = 0.6;  ///< Weight of curvature edges.
  double image_weight = 0.3;      ///< Weight of image edges.
  RangeEdgeOptions range;
  ImageEdgeOptions image;
  CurvatureEdgeOptions curvature;
  int num_threads = 0;
};

/// The three kinds of edges of a frame and what they say together. All of the surface map's size.
struct SceneEdges {
  Image<RangeEdge> range;
  Image<std::uint8_t> image;      ///< 1 on an edge; all 0 without colour.
  Image<std::uint8_t> curvature;  ///< 1 on an edge.
  Image<float> likelihood;        ///< The edge image, in [0, 1].
};

/// The edge image (paper, V.2): the blurred, weighted average of the three masks. It is the
/// relative likelihood that a pixel is on the boundary of an object. It is clamped to 1, the value
/// on a straight edge of the kind with the largest weight.
Image<float> edge_image(const Image<RangeEdge>& range, const Image<std::uint8_t>& image,
                        const Image<std::uint8_t>& curvature, const EdgeImageOptions& options = {});

/// All edges of a frame. `rgb` is its reduced_color, empty without colour.
SceneEdges scene_edges(const SurfaceMap& map, const Image<Eigen::Vector3f>& rgb,
                       const EdgeImageOptions& options = {});

}  // namespace bpa::features
