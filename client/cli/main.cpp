// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "client/cli/commands.hpp"

int main(int argc, char** argv) {
  bpa::cli::catch_interrupts();
  CLI::App program("Talks to a running bpa-server: sends frames, shows what is found.",
                   "bpa-client");
  program.require_subcommand(1);
  program.fallthrough();
  bpa::cli::Common common;
  bpa::cli::add_common(program, common);
  bpa::cli::add_send(program, common);
  bpa::cli::add_watch(program, common);
  bpa::cli::add_detect(program, common);
  bpa::cli::add_questions(program, common);
  bpa::cli::add_record(program, common);
  bpa::cli::add_play(program, common);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "bpa-client: " << error.what() << '\n';
    return 1;
  }
}
