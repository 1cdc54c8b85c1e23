// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace bpa::cli {

/// A progress bar on stderr; draws nothing when that is not a terminal. Gone when destroyed.
class Progress {
 public:
  Progress(std::string title, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total are done; `item` is what is being worked on.
  void show(int done, const std::string& item = {});
  /// Removes the bar, so that something else can be printed; the next show() draws it again.
  void clear();

 private:
  std::string title_;
  int total_;
  bool terminal_;
  bool drawn_ = false;
};

}  // namespace bpa::cli
