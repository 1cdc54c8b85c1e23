// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/command.hpp"

#include <sstream>

#include <CLI/CLI.hpp>

namespace bpa::cli {

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("--threads", options.threads, "Number of threads; 0 = one per core")
      ->check(CLI::Range(0, 256))
      ->type_name("N");
  command.add_option("--seed", options.seed, "Seed of everything random; same seed, same answer")
      ->type_name("N");
}

void add_split_option(CLI::App& command, std::string& split) {
  command.add_option("--split", split, "Split of the data set")
      ->type_name("NAME")
      ->capture_default_str();
}

void add_split_options(CLI::App& command, DatasetOptions& options) {
  add_split_option(command, options.split);
  command
      .add_option("--scenes", options.scenes, "Scenes of the split, such as 1,4; all if not given")
      ->delimiter(',')
      ->type_name("LIST");
}

void add_dataset_options(CLI::App& command, DatasetOptions& options) {
  command.add_option("--bop", options.folder, "Folder of a BOP data set with truth")
      ->required()
      ->type_name("DIR");
  add_split_options(command, options);
}

void add_library_option(CLI::App& command, std::string& folder) {
  command.add_option("--library", folder, "Folder of the model library")
      ->required()
      ->type_name("DIR");
}

void add_min_visible_option(CLI::App& command, double& fraction) {
  command
      .add_option("--min-visible", fraction,
                  "Visible fraction from which on an instance counts, 0 to 1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

std::vector<std::string> split_commas(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream in(list);
  for (std::string part; std::getline(in, part, ',');) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

}  // namespace bpa::cli
