// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/supervision.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/guarded.hpp"
#include "server/service_manager.hpp"

namespace bpa::server {
namespace {

using std::chrono::microseconds;

/// The server is looked at so often, and twice as often as systemd asks for.
constexpr microseconds kLook{500'000};
/// What leaving may take: a camera's driver has 2 s of it.
constexpr auto kTimeToLeave = std::chrono::seconds(5);
/// What was sent last needs this to arrive.
constexpr auto kTimeToArrive = std::chrono::milliseconds(200);

/// Tells it, or logs why it cannot, once for each text.
class Teller {
 public:
  explicit Teller(const LogHook& hook) : hook_(hook) {}

  void tell(const std::string& lines) {
    const Status status = manager_.tell(lines);
    if (!status.ok() && status.message != last_failure_) {
      log(hook_, LogLevel::warning, "systemd is not told: " + status.message);
    }
    last_failure_ = status.message;
  }
  microseconds look() const {
    const microseconds time = manager_.watchdog_time();
    return time.count() > 0 ? std::min(kLook, time / 2) : kLook;
  }

 private:
  const ServiceManager manager_;
  const LogHook hook_;
  std::string last_failure_;
};

/// Whether a signal came in time.
bool wait_for_signal(const sigset_t& signals, microseconds time) {
  const timespec limit{time.count() / 1'000'000, time.count() % 1'000'000 * 1000};
  return sigtimedwait(&signals, nullptr, &limit) > 0 || (errno != EAGAIN && errno != EINTR);
}

/// Ends the process; the thread that hangs cannot be joined.
[[noreturn]] void leave(Server& server, const Status& why) {
  std::mutex mutex;
  std::condition_variable changed;
  bool left = false;
  std::thread([&] {
    (void)guarded("the server cannot leave", [&] { server.abandon(why); });
    const std::lock_guard<std::mutex> lock(mutex);
    left = true;
    changed.notify_all();
  }).detach();
  std::unique_lock<std::mutex> lock(mutex);
  changed.wait_for(lock, kTimeToLeave, [&] { return left; });
  std::this_thread::sleep_for(kTimeToArrive);
  std::_Exit(kExitHung);
}

}  // namespace

void serve_until_signal(std::unique_ptr<Server> server, const sigset_t& signals,
                        const LogHook& hook) {
  Teller systemd(hook);
  systemd.tell("READY=1\nSTATUS=serving");
  while (!wait_for_signal(signals, systemd.look())) {
    const Status health = server->health();
    if (health.ok()) {
      systemd.tell("WATCHDOG=1");
      continue;
    }
    systemd.tell("STOPPING=1\nSTATUS=" + health.message);
    leave(*server, health);
  }
  systemd.tell("STOPPING=1\nSTATUS=stopping");
  log(hook, LogLevel::info, "stopping; a second signal does not wait for the search that runs");
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  server.reset();
}

}  // namespace bpa::server
