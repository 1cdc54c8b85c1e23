// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/status.hpp"

namespace CLI {
class App;
}

namespace bpa::cli {

/// What the command line asked for: set while it is parsed, run afterwards. A failure is one line
/// on stderr and exit code 1.
using Action = std::function<Status()>;

/// What every command has.
struct CommonOptions {
  int threads = 0;
  std::uint64_t seed = 0;
};

/// Adds --threads and --seed.
void add_common_options(CLI::App& command, CommonOptions& options);

/// A split of a data set in the BOP layout.
struct DatasetOptions {
  std::string folder, split = "test";
  std::vector<int> scenes;  ///< Empty: all.
};

/// Adds --split.
void add_split_option(CLI::App& command, std::string& split);
/// Adds --split and --scenes.
void add_split_options(CLI::App& command, DatasetOptions& options);
/// Adds --bop, --split and --scenes for frames with truth.
void add_dataset_options(CLI::App& command, DatasetOptions& options);
/// Adds --library, which is required.
void add_library_option(CLI::App& command, std::string& folder);
/// Adds --min-visible.
void add_min_visible_option(CLI::App& command, double& fraction);

/// A command declares itself and its options on the program and sets `action` when it is chosen;
/// see the list in main.cpp. Wrong usage is a CLI::ParseError.
void add_model_command(CLI::App& program, Action& action);
void add_detect_command(CLI::App& program, Action& action);
void add_evaluate_command(CLI::App& program, Action& action);
void add_train_command(CLI::App& program, Action& action);
void add_simulate_command(CLI::App& program, Action& action);
void add_bench_command(CLI::App& program, Action& action);

/// The experiments of `bpa bench`.
void add_bench_alignment(CLI::App& bench, Action& action);
void add_bench_accuracy(CLI::App& bench, Action& action);
void add_bench_models(CLI::App& bench, Action& action);
void add_bench_sensor(CLI::App& bench, Action& action);

/// "a,b,,c" as a, b, c.
std::vector<std::string> split_commas(const std::string& list);

}  // namespace bpa::cli
