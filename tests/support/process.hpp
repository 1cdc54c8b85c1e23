// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <sys/types.h>

namespace bpa::support {

/// A child process. Told to end when destroyed, killed if it does not.
class Process {
 public:
  /// Starts a program with its arguments; its output goes to `log_path` (empty: nowhere).
  explicit Process(const std::vector<std::string>& command, const std::string& log_path = "");
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  /// The exit code, 128 + the signal that ended it, or -1 when it does not end in time.
  int wait(std::chrono::milliseconds timeout);

 private:
  pid_t pid_ = -1;
};

/// Runs a program to its end; the exit code as Process::wait gives it.
int run(const std::vector<std::string>& command, const std::string& log_path,
        std::chrono::milliseconds timeout = std::chrono::milliseconds(60000));

/// A DDS domain that tests running at the same time do not share.
int test_domain();
/// A ROS namespace likewise.
std::string test_namespace();
/// The command line of bin/`program` on this machine, in this test's domain and namespace.
std::vector<std::string> own_command(const std::string& program,
                                     const std::vector<std::string>& arguments = {});
/// A folder of this process for files, made on first use, gone when this process ends.
std::string scratch_folder();
/// The whole text of a file; empty when there is none.
std::string read_text(const std::string& path);

}  // namespace bpa::support
