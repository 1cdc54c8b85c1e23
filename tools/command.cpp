// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command.hpp"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <mutex>
#include <sstream>

#include <unistd.h>

#include "core/base/parallel.hpp"

namespace bpa::cli {

void print_warnings(const std::string& name, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "warning: %s: %s\n", name.c_str(), warning.c_str());
  }
}

void add_options(CLI::App& command, const std::vector<Option>& options,
                 std::initializer_list<OptionField> fields) {
  for (const OptionField& field : fields) {
    const auto option = std::ranges::find(options, field.field, &Option::path);
    assert(option != options.end());
    std::ostringstream text;
    text << option->description << ' ' << option->rule.min << " to " << option->rule.max << '.';
    std::visit(
        [&]<class Value>(Value value) {
          if constexpr (std::is_pointer_v<Value>)
            command.add_option(field.option, *value, text.str())->capture_default_str();
        },
        option->value);
  }
}

void add_common_options(CLI::App& command, CommonOptions& options) {
  add_option(command, "--threads", options.threads, "Number of threads; 0 = one per core", "N")
      ->check(CLI::Range(0, 256));
  add_option(command, "--seed", options.seed, "Seed of everything random; same seed, same answer",
             "N");
}

void add_split_option(CLI::App& command, std::string& split) {
  add_option(command, "--split", split, "Split of the data set", "NAME");
}

void add_split_options(CLI::App& command, DatasetOptions& options) {
  add_split_option(command, options.split);
  add_option(command, "--scenes", options.scenes,
             "Scenes of the split, such as 1,4; all if not given", "LIST")
      ->delimiter(',');
}

void add_dataset_options(CLI::App& command, DatasetOptions& options) {
  add_option(command, "--bop", options.folder, "Folder of a BOP data set with truth", "DIR")
      ->required();
  add_split_options(command, options);
}

void add_library_option(CLI::App& command, std::string& folder) {
  add_option(command, "--library", folder, "Folder of the model library", "DIR")->required();
}

void add_min_visible_option(CLI::App& command, double& fraction) {
  add_option(command, "--min-visible", fraction,
             "Visible fraction from which on an instance counts, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
}

Progress::Progress(std::string title, int total)
    : title_(std::move(title)), total_(std::max(total, 1)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::show(int done, const std::string& item) {
  if (!terminal_) return;
  constexpr int kWidth = 30;
  const int filled = std::clamp(kWidth * done / total_, 0, kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %d/%d %s", title_.c_str(), bar.c_str(), done, total_,
               item.substr(0, 30).c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

void run_all(const std::string& title, int count, int num_threads,
             const std::function<void(int)>& work) {
  Progress progress(title, count);
  std::mutex mutex;
  int done = 0;
  parallel_for(count, num_threads, [&](int i) {
    work(i);
    const std::lock_guard lock(mutex);
    progress.show(++done);
  });
}

}  // namespace bpa::cli
