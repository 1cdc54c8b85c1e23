// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "client/cli/commands.hpp"

namespace bpa::cli {

int run_bpa_client(int argc, char** argv) {
  catch_interrupts();
  CLI::App program("Talks to a running bpa-server: sends frames, shows what is found.",
                   "bpa-client");
  program.require_subcommand(1);
  program.fallthrough();
  program.set_version_flag("--version", BPA_VERSION);
  Common common;
  add_common(program, common);
  add_send(program, common);
  add_watch(program, common);
  add_tracks(program, common);
  add_detect(program, common);
  add_questions(program, common);
  add_record(program, common);
  add_play(program, common);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "bpa-client: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

}  // namespace bpa::cli
