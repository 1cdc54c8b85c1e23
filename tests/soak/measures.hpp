// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

namespace bpa::soak {

/// What a process held at one moment.
struct Reading {
  double seconds = 0;  ///< Since the load began.
  double memory_mb = 0;
  double descriptors = 0;
  double threads = 0;
};

/// Of a process of this user; all zero once it has ended.
inline Reading read_process(pid_t pid, double seconds) {
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

/// The value below or at which `percent` of the values lie; 0 without values.
inline double percentile(std::vector<double> values, double percent) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto place = static_cast<std::size_t>(percent / 100 * static_cast<double>(values.size()));
  return values[std::min(place, values.size() - 1)];
}

/// One field of the readings from `begin` to `end`, seconds.
inline std::vector<double> during(const std::vector<Reading>& readings, double begin, double end,
                                  double Reading::*field) {
  std::vector<double> values;
  for (const Reading& reading : readings) {
    if (reading.seconds >= begin && reading.seconds <= end) values.push_back(reading.*field);
  }
  return values;
}

}  // namespace bpa::soak
