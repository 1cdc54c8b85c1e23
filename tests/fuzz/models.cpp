// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The files of an object model's folder, and score layers.
#include <cstring>

#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "core/io/private/model_parts.hpp"
#include "core/score/score_layer.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

/// The points of the surface that indices are read for.
constexpr std::size_t kPoints = 12;

ModelSource small_model() {
  ModelSource model;
  model.name = "brick";
  model.number = 1;
  model.diameter = 0.1;
  model.symmetry.discrete = {{Eigen::Quaterniond(0, 0, 1, 0), {0.001, 0, 0}}};
  model.symmetry.continuous = {{Eigen::Vector3d(0, 0.6, 0.8), {0.01, 0.02, 0.03}}};
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto x = static_cast<float>(i);
    model.surface.points.emplace_back(0.006f * x, 0.002f * static_cast<float>(i % 3), 0.01f);
    model.surface.normals.push_back(Eigen::Vector3f(1, 2, x).normalized());
    model.surface.colors.push_back({9, 9, 9});
    model.normal_variance.push_back(0.01f);
  }
  return model;
}

void run_description(std::string_view bytes) {
  const auto description = io::read_description(file_of(bytes, "model.json"));
  if (description.ok()) (void)io::description_text(*description);
}

std::vector<std::string> description_seeds() {
  io::ModelDescription description{small_model(), kPoints, {}};
  description.files["surface.ply"] = {123, "0123456789abcdef"};
  return {io::description_text(description)};
}

/// The files of arrays are mapped: their bytes begin at a page.
void run_index(std::string_view bytes) {
  const auto mapped = io::map_file(file_of(bytes, "index.bin"));
  if (!mapped.ok()) return;
  const auto file = io::parse_index(*mapped, kPoints, "index.bin");
  if (!file.ok() || file->index == nullptr) return;
  derive_index(small_model(), *file->index);
  ModelSource model = small_model();
  model.normal_variance = file->normal_variance;
  model.prepared = file->index;
  (void)make_object_model(model, 1);
}

std::vector<std::string> index_seeds() {
  const auto index = build_index(small_model(), 1);
  return {io::index_bytes(*index, small_model().normal_variance)};
}

void run_occupancy(std::string_view bytes) {
  const auto grid = io::parse_occupancy(bytes, "occupancy.bin");
  if (!grid.ok()) return;
  for (const OccupancyCell& cell : grid->cells) {
    require((cell.place.array() < grid->size.array()).all(), "each cell is in the grid");
  }
  require(io::occupancy_bytes(*grid).ok(), "what was read can be written");
}

std::vector<std::string> occupancy_seeds() {
  OccupancyGrid grid;
  grid.cell = 0.01f;
  grid.size = {4, 3, 2};
  OccupancyCell cell{{1, 2, 1}, {}};
  cell.buckets[0] = {0.5f, 7, {0.015f, 0.025f, 0.015f}, {0, 0, 1}, 0.01f};
  grid.cells = {cell, cell};
  grid.cells[1].buckets[1] = cell.buckets[0];
  return {*io::occupancy_bytes(grid)};
}

void run_score_layers(std::string_view bytes) {
  const auto layers = score::score_layers_from_json(std::string(bytes), "score_layers.json");
  if (!layers.ok()) return;
  for (const score::ScoreLayer& layer :
       {layers->round_two, layers->round_three, layers->without_color}) {
    for (const auto& component : layer.components) (void)component.at(0.5);
  }
  (void)score::to_json(*layers);
}

std::vector<std::string> score_layers_seeds() {
  return {score::to_json(score::default_score_layers())};
}

}  // namespace

std::vector<Target> model_targets() {
  const char* const parts = "core/io/model_parts.cpp";
  return {{"model_description", parts, run_description, description_seeds},
          {"model_index", parts, run_index, index_seeds, 65536},
          {"model_occupancy", parts, run_occupancy, occupancy_seeds},
          {"score_layers", "core/score/score_layer_json.cpp", run_score_layers, score_layers_seeds,
           65536}};
}

}  // namespace bpa::fuzz
