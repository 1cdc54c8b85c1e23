// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include <bpa/client.hpp>

// One function per subcommand: each adds itself to the program and sets `exit_code` when it ran.
// 0 done, 1 failed with one clear line; usage errors are 2.

namespace bpa::cli {

/// What every subcommand has.
struct Common {
  ClientOptions options;
  bool localhost = false;
  double timeout_s = 5;
  int exit_code = 0;

  /// Connects and runs body(); prints the failure of either and remembers the exit code. A body
  /// that subscribes ends the client, by close(), before what its callbacks refer to.
  void run(const std::function<Status(Client)>& body);
};

/// Ends the connection: no callback runs any more.
inline void close(Client) {}

/// The options that every subcommand has.
void add_common(CLI::App& program, Common& common);
void add_send(CLI::App& program, Common& common);
void add_watch(CLI::App& program, Common& common);
void add_detect(CLI::App& program, Common& common);
void add_models(CLI::App& program, Common& common);  ///< models, load, unload
void add_status(CLI::App& program, Common& common);
void add_play(CLI::App& program, Common& common);
void add_record(CLI::App& program, Common& common);

/// Has SIGINT and SIGTERM end the program in good order.
void catch_interrupts();
/// True after SIGINT or SIGTERM.
bool interrupted();

}  // namespace bpa::cli
