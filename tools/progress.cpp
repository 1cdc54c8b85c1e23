// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <unistd.h>

namespace bpa::cli {

Progress::Progress(std::string title, int total)
    : title_(std::move(title)), total_(std::max(total, 1)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear(); }

void Progress::show(int done, const std::string& item) {
  if (!terminal_) return;
  constexpr int kWidth = 30;
  const int filled = std::clamp(kWidth * done / total_, 0, kWidth);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %d/%d %s", title_.c_str(), bar.c_str(), done, total_,
               item.substr(0, 30).c_str());
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace bpa::cli
