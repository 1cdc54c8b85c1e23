// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/advice.hpp"

#include <utility>

#include "core/doctor/result_check.hpp"

namespace bpa::server {

std::string Advice::on(const Frame& frame, const SceneInterpretations& result, double max_range_m) {
  constexpr auto kAgainAfter = std::chrono::seconds(10);
  if (!doctor::says_little(result)) return {};
  std::unique_lock<std::mutex> lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - asked_ >= kAgainAfter || asked_.time_since_epoch().count() == 0) {
    asked_ = now;
    lock.unlock();
    const std::string says = doctor::advice_on(frame, result, max_range_m);
    lock.lock();
    camera_ = frame.frame_id;
    if (std::exchange(said_, says) != says && !says.empty()) {
      log(log_, LogLevel::warning, "little is found in frames of " + camera_ + ": " + says);
    }
  }
  return camera_ == frame.frame_id ? said_ : "";
}

std::string Advice::known(const Frame& frame, const SceneInterpretations& result) const {
  if (!doctor::says_little(result)) return {};
  const std::lock_guard<std::mutex> lock(mutex_);
  return camera_ == frame.frame_id ? said_ : "";
}

}  // namespace bpa::server
