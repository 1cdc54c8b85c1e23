// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/io/image_file.hpp"
#include "core/model/object_model.hpp"

namespace bpa::draw {

/// A sheet that shows a model: six sides in its colours with range edges (cyan) and symmetry axes
/// (blue), how curved it is and how much its normals vary, and its noise curves.
io::ColorImage model_sheet(const ObjectModel& model);

}  // namespace bpa::draw
