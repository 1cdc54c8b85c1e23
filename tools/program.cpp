// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>

#include "tools/command.hpp"

namespace bpa::cli {

int run_program(CLI::App& program, int argc, char** argv) {
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program.get_name().c_str(), error.what());
    return 1;
  }
  return 0;
}

int run_bpa(int argc, char** argv) {
  CLI::App program{"bpa: known objects in RGB-D frames, by Bingham Procrustean Alignment", "bpa"};
  program.require_subcommand(1);
  program.set_version_flag("--version", BPA_VERSION);
  add_model_command(program);
  add_detect_command(program);
  add_calibrate_command(program);
  add_track_command(program);
  add_evaluate_command(program);
  add_train_command(program);
  add_simulate_command(program);
  add_doctor_command(program);
  CLI::App& bench = *program.add_subcommand("bench", "Run an experiment");
  bench.require_subcommand(1);
  add_bench_accuracy(bench);
  add_bench_speed(bench);
  return run_program(program, argc, argv);
}

}  // namespace bpa::cli
