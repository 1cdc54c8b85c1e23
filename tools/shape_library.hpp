// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/command.hpp"

namespace bpa::cli {

/// Models of sim::varied_objects, so that a library of any size can be measured.
constexpr int kFirstShapeNumber = 100001;  ///< The model of object 0; beyond those of data sets.

/// Makes the models of the first `count` objects that the folder does not hold yet, each as `bpa
/// model from-mesh` does, with a progress bar. Throws a Failure.
void complete_shape_library(const std::string& folder, int count, const CommonOptions& common);

}  // namespace bpa::cli
