// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/base/clock.hpp"

namespace bpa {
namespace {

class SteadyClock : public WaitableClock {
 public:
  TimePoint now() const override { return std::chrono::steady_clock::now(); }
  void wait_until(std::condition_variable& wake, std::unique_lock<std::mutex>& lock,
                  TimePoint until) override {
    wake.wait_until(lock, until);
  }
};

}  // namespace

std::shared_ptr<WaitableClock> steady_clock() { return std::make_shared<SteadyClock>(); }

}  // namespace bpa
