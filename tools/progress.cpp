// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>

#include <unistd.h>

#include "core/base/parallel.hpp"

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

void run_all(const std::string& title, int count, int num_threads,
             const std::function<void(int)>& work) {
  Progress progress(title, count);
  std::mutex mutex;
  int done = 0;
  parallel_for(count, num_threads, [&](int i) {
    work(i);
    const std::lock_guard lock(mutex);
    progress.show(++done);
  });
}

}  // namespace bpa::cli
