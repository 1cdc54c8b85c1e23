// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <string>

#include <sys/types.h>

namespace bpa::support {

/// What goes when this program ends: its folder, and the memory that killed processes had shared.
class Leftovers {
 public:
  static Leftovers& all() {
    static Leftovers one;
    return one;
  }
  ~Leftovers() {
    std::error_code error;
    for (const std::string& path : paths_) std::filesystem::remove_all(path, error);
  }
  Leftovers(const Leftovers&) = delete;
  Leftovers& operator=(const Leftovers&) = delete;

  void add(const std::string& path) {
    const std::lock_guard<std::mutex> lock(mutex_);
    paths_.insert(path);
  }
  /// Before a process is killed, which then cannot remove its files itself.
  void add_shared_memory_of(pid_t pid) {
    std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
    for (std::string line; std::getline(maps, line);) {
      const std::size_t path = line.find("/dev/shm/fast_datasharing_");
      if (path != std::string::npos) add(line.substr(path));
    }
  }

 private:
  Leftovers() = default;

  std::mutex mutex_;
  std::set<std::string> paths_;
};

}  // namespace bpa::support
