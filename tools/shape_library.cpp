// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/shape_library.hpp"

#include "core/io/model_file.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "core/sim/objects.hpp"
#include "tools/posed_views.hpp"

namespace bpa::cli {
namespace {

constexpr int kFirstNumber = 100001;

std::map<int, std::string> shapes_in(const std::string& folder, int count) {
  std::map<int, std::string> shapes;
  for (const std::string& name : io::list_models(folder)) {
    const int number = or_throw(io::describe_model(folder, name)).number;
    if (number >= kFirstNumber && number < kFirstNumber + count) shapes[number] = name;
  }
  return shapes;
}

}  // namespace

std::map<int, std::string> complete_shape_library(const std::string& folder, int count,
                                                  const CommonOptions& common) {
  std::map<int, std::string> shapes = shapes_in(folder, count);
  if (std::ssize(shapes) == count) return shapes;
  const std::vector<sim::SimulatedObject> objects = sim::varied_objects(count, common.threads);
  Progress progress("shapes", count);
  for (int i = 0; i < count; ++i) {
    const sim::SimulatedObject& object = objects[i];
    if (!shapes.emplace(kFirstNumber + i, object.name).second) continue;
    progress.show(i, object.name);
    ModelSource source = or_throw(modeling::model_source_from_mesh(
        object.mesh, object.name, kFirstNumber + i, {.num_threads = common.threads}));
    look_at(object.mesh, kSimulatedViews, common, source);
    source.symmetry = modeling::find_symmetries(source.surface, source.diameter, common.threads);
    or_throw(io::save_model(folder, source, common.threads));
  }
  return shapes;
}

}  // namespace bpa::cli
