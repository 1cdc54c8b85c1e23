// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/modeling/model_source.hpp"

// What models of meshes and of points have in common.

namespace bpa::modeling {

/// Points of a model, about: time and memory grow with them, whatever the size of the object.
constexpr double kMostPoints = 30000;

/// The model of an even surface.
ModelSource make_source(PointCloud surface, const std::string& name, int number, int num_threads);

/// That points are farther apart than was asked for, metres.
std::string coarse_warning(double spacing);

}  // namespace bpa::modeling
