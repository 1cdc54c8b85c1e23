// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/failure.hpp"
#include "core/base/options.hpp"

// The commands of bpa and the options that several of them have. A command runs when the command
// line chooses it. Wrong usage is a CLI::ParseError, every other failure another exception.

namespace bpa::cli {

/// What every command has.
struct CommonOptions {
  int threads = 0;
  std::uint64_t seed = 0;
};

/// A split of a data set in the BOP layout.
struct DatasetOptions {
  std::string folder, split = "test";
  std::vector<int> scenes;  ///< Empty: all.
};

/// Adds an option. Its help shows `type`, if given, and the default unless that is 0 or empty.
template <class Value>
CLI::Option* add_option(CLI::App& command, const char* name, Value& value, const std::string& text,
                        const char* type = nullptr) {
  CLI::Option* option = command.add_option(name, value, text);
  if (type != nullptr) option->type_name(type);
  if (value != Value()) option->capture_default_str();
  return option;
}

/// One command line option for a field of an options struct.
struct OptionField {
  const char* option;  ///< Such as "--starts".
  std::string_view field;
};

/// Adds an option for each of these fields. Texts and ranges are those of visit_fields; validate()
/// checks the ranges when the command runs.
void add_options(CLI::App& command, auto& options, std::initializer_list<OptionField> fields) {
  for (const OptionField& wanted : fields) {
    bool known = false;
    options.visit_fields([&](std::string_view name, auto& value, const FieldRule& rule) {
      if (name != wanted.field) return;
      known = true;
      std::ostringstream text;
      text << rule.description << " " << rule.min << " to " << rule.max << ".";
      command.add_option(wanted.option, value, text.str())->capture_default_str();
    });
    assert(known);
    static_cast<void>(known);
  }
}

/// Adds --threads and --seed.
void add_common_options(CLI::App& command, CommonOptions& options);
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

/// Adds a command with --threads and --seed that runs `run` with its arguments. Returns both; the
/// arguments live as long as the command.
template <class Arguments>
std::pair<CLI::App&, Arguments&> add_command(CLI::App& program, const char* name,
                                             const char* description,
                                             void (*run)(const Arguments&)) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = *program.add_subcommand(name, description);
  add_common_options(command, arguments->common);
  command.callback([arguments, run] { run(*arguments); });
  return {command, *arguments};
}

void add_model_command(CLI::App& program);
void add_detect_command(CLI::App& program);
void add_evaluate_command(CLI::App& program);
void add_train_command(CLI::App& program);
void add_simulate_command(CLI::App& program);

/// The experiments of `bpa bench`.
void add_bench_alignment(CLI::App& bench);
void add_bench_accuracy(CLI::App& bench);
void add_bench_models(CLI::App& bench);
void add_bench_sensor(CLI::App& bench);

}  // namespace bpa::cli
