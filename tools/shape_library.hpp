// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "tools/command.hpp"

namespace bpa::cli {

/// Models of the first `count` of sim::varied_objects, so that a library of any size can be
/// measured: names by number, from 100001 on, which no data set has. Those that the folder lacks
/// are made as `bpa model from-mesh` does, with a progress bar. Throws a Failure.
std::map<int, std::string> complete_shape_library(const std::string& folder, int count,
                                                  const CommonOptions& common);

}  // namespace bpa::cli
