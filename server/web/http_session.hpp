// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <list>
#include <memory>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/web/http_server.hpp"

// Private to the HTTP server: one connection.

namespace bpa::server::web {

class HttpSession;

/// What the connections have in common; of the thread of the server alone but for the counts.
struct HttpShared {
  HttpShared(Router find_route, Access who, LogHook hook)
      : router(std::move(find_route)), access(std::move(who)), log(std::move(hook)) {}

  const Router router;
  Access access;
  const LogHook log;
  HttpCounts counts;
  std::list<std::weak_ptr<HttpSession>> sessions;  ///< The oldest first.
  std::list<std::weak_ptr<HttpSession>> refused;   ///< Those that are told that there are too many.
  std::atomic<std::size_t> open{0};
  std::size_t large_bodies = 0;  ///< That are being read or handled.
};

/// One connection: a request, its answer, the next request. It lives while it reads, writes or
/// waits for an answer.
class HttpSession {
 public:
  virtual ~HttpSession() = default;

  virtual void read() = 0;
  /// Instead of read(): says that there are too many.
  virtual void refuse_full() = 0;
  virtual void close() = 0;
  /// Ends the wait for an answer that will not come: the server goes.
  virtual void abandon() = 0;
  virtual const Address& address() const = 0;
  /// Whether it waits for a request, longer than new connections have patience for.
  virtual bool gives_way() const = 0;
};

std::shared_ptr<HttpSession> make_http_session(std::shared_ptr<boost::asio::io_context> context,
                                               std::shared_ptr<HttpShared> shared,
                                               boost::asio::ip::tcp::socket socket,
                                               const Address& address);

}  // namespace bpa::server::web
