// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/geometry/camera.hpp"
#include "core/result/interpretation.hpp"
#include "server/convert/results.hpp"

namespace bpa::server::web {

/// The outlines of the placements in the image, as JSON: a list with {"model", "number", "outline",
/// "alternatives": [outline...]} for each. An outline is a list of polygons [x, y, x, y ...] in
/// pixels; empty where nothing is in sight.
std::string outlines_json(const Interpretation& interpretation, const Camera& camera,
                          const Models& models);

}  // namespace bpa::server::web
