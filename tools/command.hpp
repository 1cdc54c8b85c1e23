// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/failure.hpp"
#include "core/base/options.hpp"

// The commands of bpa, the options that several of them have, and their progress bar. A command
// runs when the command line chooses it. Wrong usage is a CLI::ParseError, every other failure
// another exception.

namespace bpa::cli {

constexpr double kDegrees = 180 / std::numbers::pi;  ///< Of a radian.

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

/// Adds an option for each of these fields of `options`; validate() checks when it runs.
void add_options(CLI::App& command, const std::vector<Option>& options,
                 std::initializer_list<OptionField> fields);

/// Adds an option of two values MIN,MAX.
template <class Value>
void add_range_option(CLI::App& command, const char* name, Value& low, Value& high,
                      const char* text) {
  const auto set = [name, &low, &high](const std::vector<Value>& range) {
    if (range[0] > range[1]) throw CLI::ValidationError(name, "MIN must not be larger than MAX");
    low = range[0];
    high = range[1];
  };
  command.add_option_function<std::vector<Value>>(name, set, text)
      ->delimiter(',')
      ->expected(2)
      ->type_name("MIN,MAX");
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

/// Adds a command with --threads and --seed that runs `run`. Its arguments live as long as it does.
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

/// To stderr, a line each.
void print_warnings(const std::string& name, const std::vector<std::string>& warnings);

/// A progress bar on stderr, if that is a terminal. The destructor removes it.
class Progress {
 public:
  Progress(std::string title, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows that `done` of the total are done, and the current item.
  void show(int done, const std::string& item = {});
  /// Removes the bar, so that something else can be printed; the next show() draws it again.
  void clear();

 private:
  std::string title_;
  int total_;
  bool terminal_;
  bool drawn_ = false;
};

/// Runs work(0) to work(count - 1) in parallel under a progress bar. Throws as parallel_for does.
void run_all(const std::string& title, int count, int num_threads,
             const std::function<void(int)>& work);

/// Runs the command that the command line chooses. Returns the exit code: 0, 1 after a failure, 2
/// after wrong usage.
int run_program(CLI::App& program, int argc, char** argv);

/// The program bpa. Returns as run_program().
int run_bpa(int argc, char** argv);

void add_model_command(CLI::App& program);
void add_detect_command(CLI::App& program);
void add_track_command(CLI::App& program);
void add_evaluate_command(CLI::App& program);
void add_calibrate_command(CLI::App& program);
void add_train_command(CLI::App& program);
void add_doctor_command(CLI::App& program);
void add_simulate_command(CLI::App& program);

/// The measurements of `bpa bench`.
void add_bench_accuracy(CLI::App& bench);
void add_bench_speed(CLI::App& bench);

}  // namespace bpa::cli
