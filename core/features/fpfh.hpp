// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/cloud/point_cloud.hpp"

namespace bpa {

/// Fast point feature histogram: three histograms of 11 bins, each summing to 100.
using Fpfh = std::array<float, 33>;

/// Fast point feature histograms (Rusu, Blodow and Beetz, ICRA 2009) of the cloud's points named by
/// `indices`, over neighbours within `radius`. The cloud needs normals; evenly spaced points make
/// features of scene and model comparable. Simplified histograms are computed once for every point
/// that some feature needs.
std::vector<Fpfh> compute_fpfh(const PointCloud& cloud, std::span<const int> indices, float radius,
                               int num_threads);

}  // namespace bpa
