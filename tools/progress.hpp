// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace bpa::cli {

/// A progress bar on stderr, if that is a terminal. The destructor removes it.
class Progress {
 public:
  Progress(std::string title, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows that `done` of the total are done, and the current item.
  void show(int done, const std::string& item = {});
  /// Removes the bar, so that something else can be printed; the next show() draws it again.
  void clear();

 private:
  std::string title_;
  int total_;
  bool terminal_;
  bool drawn_ = false;
};

/// Runs work(0) to work(count - 1) in parallel under a progress bar. Throws as parallel_for does.
void run_all(const std::string& title, int count, int num_threads,
             const std::function<void(int)>& work);

}  // namespace bpa::cli
