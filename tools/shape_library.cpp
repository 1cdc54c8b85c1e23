// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/shape_library.hpp"

#include <algorithm>

#include "core/io/model_file.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "core/sim/objects.hpp"
#include "tools/posed_views.hpp"

namespace bpa::cli {

void complete_shape_library(const std::string& folder, int count, const CommonOptions& common) {
  const std::vector<std::string> there = io::list_models(folder);
  if (std::ssize(there) >= count) return;
  const std::vector<sim::SimulatedObject> objects = sim::varied_objects(count, common.threads);
  Progress progress("shapes", count);
  for (int i = 0; i < count; ++i) {
    const sim::SimulatedObject& object = objects[i];
    if (std::ranges::binary_search(there, object.name)) continue;
    progress.show(i, object.name);
    ModelSource source = or_throw(model_source_from_mesh(
        object.mesh, object.name, kFirstShapeNumber + i, {.num_threads = common.threads}));
    look_at(object.mesh, kSimulatedViews, common, source);
    source.symmetry = find_symmetries(source.surface, source.diameter, common.threads);
    or_throw(io::save_model(folder, source, common.threads));
  }
}

}  // namespace bpa::cli
