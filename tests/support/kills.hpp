// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.hpp"
#include "tests/support/process.hpp"

namespace bpa::support {

/// How often a part is killed and must be back: BPA_KILLS, 4 otherwise.
inline int kills() {
  const char* text = std::getenv("BPA_KILLS");
  return text != nullptr ? std::atoi(text) : 4;
}

/// A part that is not back so long after its start is wedged. On a quiet machine it is back in 2 s.
inline constexpr std::chrono::milliseconds kBackWithin{10000};

/// Asks until it succeeds; what the last one said when none did in time.
inline Status within(std::chrono::milliseconds time,
                     const std::function<Status(std::chrono::milliseconds left)>& ask) {
  using std::chrono::milliseconds;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + time;
  Status status;
  do {
    const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
    status = ask(std::max(left, milliseconds(1)));
    if (status.ok()) return status;
    std::this_thread::sleep_for(milliseconds(10));
  } while (Clock::now() < end);
  return status;
}

/// A part of a running system, in a process of its own.
struct Part {
  std::function<std::shared_ptr<Process>()> start;
  std::function<Status(std::chrono::milliseconds left)> works;  ///< Called until it succeeds.
  std::function<void()> check = [] {};  ///< What else must hold each time the part is back.
  /// It is killed at a random moment of this time after its start, or after it was back.
  std::chrono::milliseconds life{1000};
};

/// Kills the part kills() times, every other time once more while it starts. Prints how long it
/// took until the part was back.
inline void kill_again_and_again(const std::string& name, const Part& part) {
  using Clock = std::chrono::steady_clock;
  std::minstd_rand random(20);
  std::vector<double> seconds;
  auto process = part.start();
  const auto kill = [&] {
    const auto moment = random() % static_cast<unsigned>(part.life.count());
    std::this_thread::sleep_for(std::chrono::milliseconds(moment));
    process->signal(SIGKILL);
    ASSERT_EQ(process->wait(std::chrono::milliseconds(5000)), 128 + SIGKILL) << name;
    process.reset();
  };
  for (int i = 0; i < kills() && !testing::Test::HasFailure(); ++i) {
    kill();
    if (i % 2 == 1) {
      process = part.start();
      kill();
    }
    const auto begin = Clock::now();
    process = part.start();
    const Status back = within(kBackWithin, part.works);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
    EXPECT_TRUE(back.ok()) << name << ", kill " << i << ": " << back.message;
    part.check();
  }
  std::sort(seconds.begin(), seconds.end());
  std::cout << name << ": killed and back " << seconds.size() << " times; back after "
            << seconds.at(seconds.size() / 2) << " s (median), " << seconds.back()
            << " s (worst)\n";
}

}  // namespace bpa::support
