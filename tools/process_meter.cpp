// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/process_meter.hpp"

#include <fstream>

#include <malloc.h>
#include <time.h>

namespace bpa::cli {
namespace {

/// What follows "KEY" and ':' in a file of such lines; empty if no line begins so.
std::string line_of(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t start = line.find_first_not_of(" \t", line.find(':') + 1);
    return start == std::string::npos ? "" : line.substr(start);
  }
  return {};
}

}  // namespace

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::optional<double> peak_memory_mb() {
  const std::string kibibytes = line_of("/proc/self/status", "VmHWM");
  if (kibibytes.empty()) return std::nullopt;
  return 1024e-6 * std::stod(kibibytes);
}

bool reset_peak_memory() {
  malloc_trim(0);
  constexpr const char* kPeakOnly = "5";  // proc_pid_clear_refs(5)
  return static_cast<bool>(std::ofstream("/proc/self/clear_refs") << kPeakOnly << std::flush);
}

std::string cpu_name() {
  const std::string name = line_of("/proc/cpuinfo", "model name");
  return name.empty() ? "unknown" : name;
}

}  // namespace bpa::cli
