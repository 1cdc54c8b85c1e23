// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/experiments/experiments.hpp"

int main(int argc, char** argv) {
  CLI::App program{"bpa-experiments: the figures that bpa's design rests on", "bpa-experiments"};
  program.require_subcommand(1);
  bpa::cli::add_alignment_experiment(program);
  bpa::cli::add_models_experiment(program);
  bpa::cli::add_sensor_experiment(program);
  bpa::cli::add_views_experiment(program);
  return bpa::cli::run_program(program, argc, argv);
}
