// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cctype>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace bpa::support {

struct HttpAnswer {
  int status = 0;                              ///< 0: no answer came.
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  std::string body;
};

/// One TCP connection to this machine, byte by byte as a test wants them.
class Connection {
 public:
  explicit Connection(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool open() const { return open_; }

  /// False once the peer takes nothing more.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// What came in time; empty: nothing, or the end.
  std::string receive(std::chrono::milliseconds timeout) {
    pollfd wait{socket_, POLLIN, 0};
    if (poll(&wait, 1, static_cast<int>(timeout.count())) <= 0) return "";
    char bytes[65536];
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    ended_ = count <= 0;
    return count > 0 ? std::string(bytes, static_cast<std::size_t>(count)) : "";
  }
  /// Whether the peer closed it, seen by receive().
  bool ended() const { return ended_; }

  /// The next answer.
  HttpAnswer answer(std::chrono::milliseconds timeout = std::chrono::seconds(10)) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    HttpAnswer answer;
    std::size_t head = std::string::npos, length = 0;
    while (head == std::string::npos || read_.size() < head + 4 + length) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          deadline - std::chrono::steady_clock::now());
      const std::string more = left.count() > 0 ? receive(left) : "";
      if (more.empty()) return {};
      read_ += more;
      if (head != std::string::npos) continue;
      head = read_.find("\r\n\r\n");
      if (head == std::string::npos) continue;
      parse_head(read_.substr(0, head), answer);
      length = std::strtoul(answer.headers["content-length"].c_str(), nullptr, 10);
    }
    answer.body = read_.substr(head + 4, length);
    read_.erase(0, head + 4 + length);
    return answer;
  }

 private:
  static void parse_head(const std::string& head, HttpAnswer& answer) {
    if (head.size() > 12) answer.status = std::atoi(head.c_str() + 9);
    for (std::size_t at = head.find("\r\n"); at != std::string::npos;) {
      const std::size_t end = head.find("\r\n", at + 2);
      const std::string line = head.substr(at + 2, end - at - 2);
      const std::size_t colon = line.find(':');
      std::string name = line.substr(0, colon);
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      if (colon != std::string::npos) {
        answer.headers[name] = line.substr(line.find_first_not_of(' ', colon + 1));
      }
      at = end;
    }
  }

  int socket_;
  bool open_ = false, ended_ = false;
  std::string read_;
};

/// The bytes of a request; Host is this machine unless `headers` have one.
inline std::string http_request(const std::string& method, const std::string& path,
                                const std::string& body = "",
                                const std::map<std::string, std::string>& headers = {}) {
  std::string text = method + " " + path + " HTTP/1.1\r\n";
  if (!headers.contains("Host")) text += "Host: 127.0.0.1\r\n";
  for (const auto& [name, value] : headers) text += name + ": " + value + "\r\n";
  if (!body.empty() || method == "POST") {
    text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  }
  return text + "\r\n" + body;
}

/// One request on a connection of its own.
inline HttpAnswer http(int port, const std::string& method, const std::string& path,
                       const std::string& body = "",
                       const std::map<std::string, std::string>& headers = {},
                       std::chrono::milliseconds timeout = std::chrono::seconds(30)) {
  Connection connection(port);
  if (!connection.open()) return {};
  connection.send(http_request(method, path, body, headers));
  return connection.answer(timeout);
}

}  // namespace bpa::support
