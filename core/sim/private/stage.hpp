// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/sim/scenery.hpp"
#include "core/sim/scenes.hpp"

// What stands on a stage, and how it is photographed.

namespace bpa::sim {

struct Stage::Impl {
  std::vector<SimulatedObject> objects;
  std::vector<SimulatedObject> distractors;
  std::vector<SimulatedObject> tables;
  SimulatedObject room;
  SimulatedObject bin;
  // Indices of meshes; the objects come first.
  int first_distractor = 0;
  int first_table = 0;
  int room_mesh = 0;
  int bin_mesh = 0;
  std::unique_ptr<RayMeshes> ray_meshes;

  const RayMeshes& meshes() const { return *ray_meshes; }
};

/// One frame with its truth; the first posed meshes of the scene are the instances, of which
/// `objects` says what they are.
SimulatedFrame capture(const KinectView& view, const std::vector<int>& objects,
                       const KinectOptions& options, std::uint64_t seed, int shot, int num_threads);

}  // namespace bpa::sim
