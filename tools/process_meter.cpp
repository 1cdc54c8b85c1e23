// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/process_meter.hpp"

#include <fstream>

#include <linux/perf_event.h>
#include <malloc.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

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

InstructionCounter::InstructionCounter() {
  perf_event_attr event{};
  event.type = PERF_TYPE_HARDWARE;
  event.size = sizeof event;
  event.config = PERF_COUNT_HW_INSTRUCTIONS;
  event.inherit = 1;
  event.exclude_kernel = 1;
  event.exclude_hv = 1;
  constexpr int kThisThread = 0, kAnyCpu = -1, kNoGroup = -1;
  file_ = static_cast<int>(
      syscall(SYS_perf_event_open, &event, kThisThread, kAnyCpu, kNoGroup, PERF_FLAG_FD_CLOEXEC));
}

InstructionCounter::~InstructionCounter() {
  if (file_ >= 0) close(file_);
}

std::optional<std::uint64_t> InstructionCounter::count() const {
  std::uint64_t count = 0;
  if (file_ < 0 || read(file_, &count, sizeof count) != sizeof count) return std::nullopt;
  return count;
}

}  // namespace bpa::cli
