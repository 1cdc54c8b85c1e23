// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/service_manager.hpp"

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/concat.hpp"

namespace bpa::server {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// A number of microseconds or a process's id; 0 for what is none.
std::int64_t number(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

}  // namespace

ServiceManager::ServiceManager() : socket_(variable("NOTIFY_SOCKET")) {
  const std::string process = variable("WATCHDOG_PID");
  if (!process.empty() && number(process) != getpid()) return;
  watchdog_time_ = std::chrono::microseconds(number(variable("WATCHDOG_USEC")));
}

Status ServiceManager::tell(const std::string& lines) const {
  if (socket_.empty()) return {};
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (socket_.size() >= sizeof address.sun_path || (socket_[0] != '/' && socket_[0] != '@')) {
    return invalid_argument("NOTIFY_SOCKET is \"", socket_,
                            "\"; it must be an absolute path, or begin with '@'");
  }
  std::memcpy(address.sun_path, socket_.data(), socket_.size());
  if (socket_[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
  const int to = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool sent = to >= 0 && ::sendto(to, lines.data(), lines.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                                        reinterpret_cast<const sockaddr*>(&address),
                                        size) == static_cast<ssize_t>(lines.size());
  const int error = errno;
  if (to >= 0) ::close(to);
  if (sent) return {};
  return unavailable("NOTIFY_SOCKET ", socket_, ": ", std::strerror(error));
}

}  // namespace bpa::server
