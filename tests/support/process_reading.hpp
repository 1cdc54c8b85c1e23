// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include <sys/types.h>

namespace bpa::support {

/// What a process held at one moment.
struct Reading {
  double seconds = 0;  ///< When, as the caller counts.
  double memory_mb = 0;
  double descriptors = 0;
  double threads = 0;
};

/// Of a process of this user; all zero once it has ended.
inline Reading read_process(pid_t pid, double seconds = 0) {
  const std::filesystem::path proc = "/proc/" + std::to_string(pid);
  std::map<std::string, double> fields;
  std::ifstream file(proc / "status");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (line.rfind("VmRSS", 0) == 0 || line.rfind("Threads", 0) == 0) {
      fields[line.substr(0, colon)] = std::stod(line.substr(colon + 1));
    }
  }
  std::error_code error;
  const std::filesystem::directory_iterator open(proc / "fd", error);
  const auto descriptors = error ? 0 : std::distance(begin(open), end(open));
  return {seconds, fields["VmRSS"] * 1024e-6, static_cast<double>(descriptors), fields["Threads"]};
}

}  // namespace bpa::support
