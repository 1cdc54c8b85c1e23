// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <bpa/client.hpp>

#include "core/base/failure.hpp"

// One function per subcommand: each adds itself to the program and runs when it is chosen. Wrong
// usage is a CLI::ParseError, every other failure another exception.

namespace bpa::cli {

/// The program bpa-client. Returns its exit code: 0, 1 after a failure, 2 after wrong usage.
int run_bpa_client(int argc, char** argv);

/// What every subcommand has.
struct Common {
  ClientOptions options;
  bool localhost = false;
  double timeout_s = 5;

  /// Connects to the server or throws a Failure. What a subscription's callback refers to must
  /// outlive the client.
  Client connect() const;
  /// The SDK's options of these.
  ClientOptions client_options() const;
};

/// The options that every subcommand has.
void add_common(CLI::App& program, Common& common);
/// models, load, unload, status
void add_questions(CLI::App& program, const Common& common);
void add_send(CLI::App& program, const Common& common);
void add_watch(CLI::App& program, const Common& common);
/// tracks, rename, hold, forget
void add_tracks(CLI::App& program, const Common& common);
void add_detect(CLI::App& program, const Common& common);
void add_play(CLI::App& program, const Common& common);
void add_record(CLI::App& program, const Common& common);

struct BagOptions {
  std::string path;                 ///< A new .mcap file.
  std::vector<std::string> topics;  ///< Empty: frames of clients and what a server publishes.
  double seconds = 0;               ///< 0: until interrupted.
};
/// Records topics as they come, with or without a server.
void record_bag(const Common& common, const BagOptions& options);

/// Has SIGINT and SIGTERM end the program in good order.
void catch_interrupts();
/// True after SIGINT or SIGTERM.
bool interrupted();
/// Waits until done() or until interrupted().
void wait_until(const std::function<bool()>& done);

}  // namespace bpa::cli
