// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/command.hpp"

// The subcommands of bpa-experiments.

namespace bpa::cli {

void add_alignment_experiment(CLI::App& program);
void add_models_experiment(CLI::App& program);
void add_sensor_experiment(CLI::App& program);
void add_views_experiment(CLI::App& program);

}  // namespace bpa::cli
