// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench: experiments. Each is its own file and its line here.
#include <CLI/CLI.hpp>

#include "tools/command.hpp"

namespace bpa::cli {

void add_bench_command(CLI::App& program, Action& action) {
  CLI::App& command = *program.add_subcommand("bench", "Run an experiment");
  command.require_subcommand(1);
  add_bench_alignment(command, action);
  add_bench_accuracy(command, action);
  add_bench_models(command, action);
  add_bench_sensor(command, action);
}

}  // namespace bpa::cli
