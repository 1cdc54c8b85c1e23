// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command.hpp"

namespace bpa::cli {

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

}  // namespace bpa::cli
