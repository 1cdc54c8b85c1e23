// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/command.hpp"

namespace bpa::cli {

/// `bpa bench alignment`: the paper's comparison of BPA with ICP from noisy starts.
void add_bench_alignment(CLI::App& bench, Action& action);
/// `bpa bench sensor`: the simulated depth camera against published figures and real frames.
void add_bench_sensor(CLI::App& bench, Action& action);

/// `bpa bench accuracy`: where on its way through the detector an object is lost.
void add_bench_accuracy(CLI::App& bench, Action& action);
/// `bpa bench models`: models from simulated scans against the true meshes.
void add_bench_models(CLI::App& bench, Action& action);

}  // namespace bpa::cli
