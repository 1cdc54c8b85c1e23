// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace bpa::support {

/// The end of sd_notify's socket that systemd has. Takes each datagram at once, as systemd does:
/// the kernel holds ten and drops what a process sends then.
class NotifySocket {
 public:
  /// `name` as in NOTIFY_SOCKET: a path, or "@..." in the abstract namespace.
  explicit NotifySocket(const std::string& name) : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0) std::abort();
    reader_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) take();
    });
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  ~NotifySocket() {
    reader_.request_stop();
    shutdown(socket_, SHUT_RDWR);  // recv() returns
    reader_.join();
    close(socket_);
  }

  /// The next datagram; empty when none comes for 20 s.
  std::string receive() {
    std::unique_lock<std::mutex> lock(mutex_);
    if (!came_.wait_for(lock, std::chrono::seconds(20), [this] { return !datagrams_.empty(); })) {
      return {};
    }
    std::string first = std::move(datagrams_.front());
    datagrams_.pop_front();
    return first;
  }

 private:
  void take() {
    char bytes[4096];
    const ssize_t size = recv(socket_, bytes, sizeof bytes, 0);
    if (size <= 0) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    datagrams_.emplace_back(bytes, static_cast<std::size_t>(size));
    came_.notify_all();
  }

  int socket_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<std::string> datagrams_;
  std::jthread reader_;
};

}  // namespace bpa::support
