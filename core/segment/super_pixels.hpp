// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/options.hpp"
#include "core/cloud/image.hpp"
#include "core/cloud/surface_map.hpp"

namespace bpa::segment {

/// The defaults are chosen by hand; tests/core/segment/boundary_recall_test.cpp measures what share
/// of the true boundaries they find.
struct SuperPixelOptions {
  int spacing_px = 8;        ///< Spacing of the first centres: the size of a super-pixel, pixels.
  int iterations = 4;        ///< Iterations of k-means.
  int min_pixels = 10;       ///< Smaller super-pixels join a neighbour if no edge is between.
  double angle_deg = 25;     ///< Angle of normals that counts as one spacing, degrees.
  double color = 12;         ///< CIELAB distance that counts as one spacing.
  double edge = 0.5;         ///< Edge likelihood that counts as one spacing.
  double strong_edge = 0.8;  ///< Edge likelihood that no super-pixel crosses.
  int num_threads = 0;       ///< 0: one for each core.
};

/// A 3-D super-pixel: a connected piece of surface of similar position, normal and colour.
struct Segment {
  std::vector<std::uint32_t> pixels;  ///< Of the surface map, ascending; not empty.
  std::vector<std::uint32_t> border;  ///< Those with one of the four neighbours outside; ascending.
  Eigen::Vector3f mean_position = Eigen::Vector3f::Zero();  ///< Camera frame, metres.
  Eigen::Vector3f mean_normal = Eigen::Vector3f::Zero();    ///< Unit length.
  Eigen::Vector3f mean_color = Eigen::Vector3f::Zero();     ///< CIELAB; 0 without colour.
};

/// Two segments that touch.
struct SegmentPair {
  int first = 0;  ///< Indices into segments, first < second.
  int second = 0;
  int contact = 0;     ///< Pairs of neighbouring pixels, one in each.
  int breaks = 0;      ///< Those of them between which the surface breaks off.
  float edge = 0;      ///< Mean edge likelihood along the contact, [0, 1].
  float affinity = 0;  ///< How likely both are of one object, see segment_affinity(), [0, 1].
};

/// A partition of the pixels that have a normal.
struct Segmentation {
  Image<std::int32_t> labels;  ///< Index into segments; -1 where there is no normal.
  std::vector<Segment> segments;
  std::vector<SegmentPair> pairs;  ///< Each once, sorted by (first, second).
};

/// Over-segments the surface by k-means on position, normal and (blurred) CIELAB colour (paper
/// section V): each pixel is compared with the nine centres about it on a grid, as SLIC does
/// (Achanta et al. 2012, "SLIC superpixels compared to state-of-the-art superpixel methods",
/// TPAMI 34). Then segments are made to keep within edges: their pixels whose edge likelihood is
/// below strong_edge are connected among themselves without crossing a break of the surface;
/// pixels on a strong edge join the more similar side. `lab` may be empty; `edges` is the edge
/// image. Both of the map's size. The same for any number of threads.
Segmentation super_pixels(const SurfaceMap& map, const Image<Eigen::Vector3f>& lab,
                          const Image<float>& edges, const SuperPixelOptions& options = {});

/// exp(-E/2) times the share of the contact without a break. E adds two squares: the contact's edge
/// likelihood divided by 0.4, and an angle divided by 40 degrees (a hollow) or 80 (a bulge). The
/// angle is that between the mean normals plus the step angle: how much steeper the line between
/// the mean positions is than on a smooth surface.
float segment_affinity(const Segment& first, const Segment& second, const SegmentPair& pair);

}  // namespace bpa::segment
