// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/mesh_file.hpp"
#include "tools/command.hpp"

// Meshes as users give them: the unit may have to be guessed.

namespace bpa::cli {

/// Adds --scale and --unit, of which one may be given; `scale` is 0 without.
void add_unit_options(CLI::App& command, double& scale);

/// Adds --unit, which sets metres of one unit.
CLI::Option* add_unit_option(CLI::App& command, double& metres, const char* text);

/// Metres of one unit of files that do not say theirs. `largest` is the longest side of all their
/// objects, which are taken to be 2 cm to 3 m long: metres up to 3, centimetres up to 20, else
/// millimetres.
double guess_unit(double largest);

/// Prints that the points of a file, whose format says no unit, are taken to be in metres. Throws a
/// Failure with the choices where objects are seldom so large.
void assume_metres(const std::string& path, const std::vector<Eigen::Vector3f>& points);

/// Reads meshes of one unit. If `scale` is 0, it is guessed for those whose format does not fix it
/// and set; what was assumed is printed. Throws as or_throw() does.
std::vector<io::MeshFile> read_meshes(const std::vector<std::string>& paths, double& scale);

}  // namespace bpa::cli
