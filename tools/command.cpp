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

std::vector<std::string> split_commas(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream in(list);
  for (std::string part; std::getline(in, part, ',');) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

}  // namespace bpa::cli
