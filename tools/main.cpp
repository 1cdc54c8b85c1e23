// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>

#include "tools/command.hpp"

int main(int argc, char** argv) {
  CLI::App program{"bpa: known objects in RGB-D frames, by Bingham Procrustean Alignment", "bpa"};
  program.require_subcommand(1);
  program.set_version_flag("--version", BPA_VERSION);
  bpa::cli::add_model_command(program);
  bpa::cli::add_detect_command(program);
  bpa::cli::add_evaluate_command(program);
  bpa::cli::add_train_command(program);
  bpa::cli::add_simulate_command(program);
  bpa::cli::add_doctor_command(program);
  CLI::App& bench = *program.add_subcommand("bench", "Run an experiment");
  bench.require_subcommand(1);
  bpa::cli::add_bench_alignment(bench);
  bpa::cli::add_bench_accuracy(bench);
  bpa::cli::add_bench_models(bench);
  bpa::cli::add_bench_sensor(bench);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bpa: %s\n", error.what());
    return 1;
  }
}
