// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

#include "tools/command.hpp"

namespace bpa::cli {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;

/// Every subcommand, in the order of the help text.
constexpr void (*kCommands[])(CLI::App&, Action&) = {
    add_model_command, add_detect_command,   add_evaluate_command,
    add_train_command, add_simulate_command, add_bench_command,
};

int run(int argc, char** argv) {
  CLI::App program{"bpa: known objects in RGB-D frames, by Bingham Procrustean Alignment", "bpa"};
  program.require_subcommand(1);
  program.set_version_flag("--version", BPA_VERSION);
  Action action;
  for (const auto add : kCommands) add(program, action);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kUsage;
  }
  const Status status = action ? action() : Status();
  if (status.ok()) return kDone;
  std::fprintf(stderr, "bpa: %s\n", status.message.c_str());
  return kFailed;
}

}  // namespace

}  // namespace bpa::cli

int main(int argc, char** argv) {
  try {
    return bpa::cli::run(argc, argv);
  } catch (const std::exception& error) {  // out of memory, mostly
    std::fprintf(stderr, "bpa: %s\n", error.what());
    return 1;
  }
}
