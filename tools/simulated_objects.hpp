// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/bop_dataset.hpp"
#include "core/sim/scenes.hpp"
#include "tools/command.hpp"

// Which objects are simulated, and how what is seen of them is written.

namespace bpa::cli {

constexpr double kDepthUnitMm = 1;  ///< Of depth images: what such a camera delivers.

/// Where the objects come from; all household objects where nothing is given.
struct ObjectChoice {
  std::string meshes;               ///< Folder of meshes.
  std::vector<std::string> models;  ///< Names of our objects.
  double scale = 0;                 ///< Metres of a unit of the meshes; 0 = guess.
};

/// Adds --meshes and --models.
void add_object_options(CLI::App& command, ObjectChoice& objects);
/// Adds --sensor; with "mixed" each `unit` (a scene, a sequence) has one of the three.
void add_sensor_option(CLI::App& command, sim::SensorOptions& sensor, bool& mixed,
                       const std::string& unit);

/// All of these throw a Failure.
std::vector<sim::SimulatedObject> chosen_objects(const ObjectChoice& choice, int num_threads);
std::vector<sim::SimulatedObject> named_objects(const std::vector<std::string>& names,
                                                int num_threads);
sim::SimulatedObject read_object(const std::string& path, double scale);

/// The models of a data set; object i has obj_id i + 1.
void write_models(const std::string& out, const std::vector<sim::SimulatedObject>& objects);

/// The truth of a frame as a BOP scene has it, in the order of its instances.
std::vector<io::BopInstanceRecord> records_of(const sim::SimulatedFrame& frame);

/// bpa simulate sequence.
void add_sequence_command(CLI::App& simulate);

}  // namespace bpa::cli
