// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/random.hpp"
#include "core/sim/motion.hpp"
#include "core/sim/private/table_body.hpp"
#include "core/sim/sequence.hpp"

// A sequence in the making: bodies on a table, and what happens to them, one event after the other.

namespace bpa::sim {

/// A motion of one body. Before it the body is at its place, after it at another.
struct Move {
  double start = 0, seconds = 0;
  PosePath world_from_rest;
};

/// An arm that is there for a while.
struct ArmVisit {
  int arm = 0;  ///< Place in make_arms().
  double start = 0, end = 0;
  std::function<Pose(double seconds)> world_from_arm;
};

/// A disc of the table.
struct Disc {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0;

  bool overlaps(const Disc& other) const {
    return (center - other.center).norm() < radius + other.radius;
  }
};

struct SequenceDraft {
  SequenceDraft(const SequenceOptions& given, const RandomStream& stream, const Orbit& camera)
      : options(given), random(stream), orbit(camera) {}

  const SequenceOptions& options;
  RandomStream random;
  Orbit orbit;
  std::vector<TableBody> bodies;  ///< First the instances.
  int num_instances = 0;
  std::optional<int> twin;       ///< The first of two instances that follow each other.
  std::optional<Disc> reserved;  ///< Where the twins pass.
  double disc = 0;               ///< The bodies are within this radius of the origin, metres.
  std::vector<Place> places;     ///< After all moves so far.
  std::vector<Place> first_places;
  std::vector<std::vector<Move>> moves;  ///< Of each body, by start.
  std::vector<ArmVisit> visits;
  std::vector<SequenceEvent> events;

  SpeedLimits object_limits();  ///< A random share of the largest.
  /// Whether only body `self` is on this disc.
  bool is_free(const Disc& disc, int self) const;
  Pose world_from_rest_at(int body, double seconds) const;
  bool is_twin(int body) const { return twin && (body == *twin || body == *twin + 1); }
};

/// Each makes one event whose motion begins at `start`. Returns when it ends; nothing where no draw
/// finds room.
std::optional<double> add_push(SequenceDraft& draft, double start);
std::optional<double> add_pick(SequenceDraft& draft, double start);
std::optional<double> add_occlusion(SequenceDraft& draft, double start);
std::optional<double> add_passing(SequenceDraft& draft, double start);
/// Turns instance 0 until its telltales are in sight.
std::optional<double> add_turn(SequenceDraft& draft, double start);

}  // namespace bpa::sim
