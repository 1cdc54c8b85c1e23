// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "server/web/access.hpp"
#include "server/web/http.hpp"

namespace bpa::server::web {

/// What became of connections and requests.
struct HttpCounts {
  std::atomic<std::uint64_t> connections{0};    ///< That were taken, the refused ones too.
  std::atomic<std::uint64_t> requests{0};       ///< That were answered, refusals too.
  std::atomic<std::uint64_t> full{0};           ///< Connections refused: as many as may were there.
  std::atomic<std::uint64_t> slow_requests{0};  ///< Connections ended: no whole request in time.
  std::atomic<std::uint64_t> slow_readers{0};   ///< Connections ended: an answer was not read.
  std::atomic<std::uint64_t> malformed{0};      ///< Not HTTP, or a head that is too large.
  /// Requests refused, by cause (kRefusalNames).
  std::array<std::atomic<std::uint64_t>, kRefusals> refused{};
};

/// Finds what serves a request, by method and path. Runs on the thread of the server.
using Router = std::function<Result<Route>(const RequestHead&)>;

/// Serves HTTP/1.1 on one thread of its own until it is destroyed.
class HttpServer {
 public:
  /// `unavailable` where the address cannot be listened on.
  static Result<std::unique_ptr<HttpServer>> create(const ListenAddress& listen, Access access,
                                                    Router router, LogHook log);
  virtual ~HttpServer() = default;
  /// The one that was asked for, or that the system chose for 0.
  virtual std::uint16_t port() const = 0;
  virtual const HttpCounts& counts() const = 0;
  virtual std::size_t open_connections() const = 0;
};

}  // namespace bpa::server::web
