// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/http_server.hpp"

#include <algorithm>
#include <chrono>
#include <list>
#include <thread>
#include <utility>

#include <boost/asio/steady_timer.hpp>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "server/web/http_session.hpp"

namespace bpa::server::web {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Three viewers have 21: a browser opens six, and one more for what another tab asks.
constexpr std::size_t kMaxConnections = 128;
constexpr std::size_t kMaxConnectionsOfAddress = 64;
/// More that are told so; beyond these, connections are closed without a word.
constexpr std::size_t kMaxRefusedConnections = 64;
constexpr int kMaxBacklog = 64;  ///< Connections that the kernel keeps for us.
constexpr std::chrono::milliseconds kAcceptPause{100};  ///< After a failure: no descriptors.

Address address_of(const tcp::endpoint& endpoint) {
  const asio::ip::address address = endpoint.address();
  return address.is_v4()
             ? asio::ip::make_address_v6(asio::ip::v4_mapped, address.to_v4()).to_bytes()
             : address.to_v6().to_bytes();
}

class BeastServer : public HttpServer {
 public:
  /// Throws a boost::system::system_error.
  BeastServer(const ListenAddress& listen, Access access, Router router, LogHook log)
      : shared_(std::make_shared<HttpShared>(std::move(router), std::move(access), std::move(log))),
        acceptor_(*context_),
        timer_(*context_) {
    const tcp::endpoint endpoint(asio::ip::make_address(listen.address), listen.port);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen(kMaxBacklog);
    port_ = acceptor_.local_endpoint().port();
    accept();
    thread_ = std::thread([this] { run(); });
  }
  ~BeastServer() override {
    context_->stop();
    thread_.join();
    // A connection that waits keeps itself and the context: its handlers have to run once more.
    error_code ignored;
    acceptor_.close(ignored);
    for (const auto* sessions : {&shared_->sessions, &shared_->refused}) {
      for (const auto& weak : *sessions) {
        if (const auto session = weak.lock()) end(*session);
      }
    }
    context_->restart();
    context_->poll();
  }

  std::uint16_t port() const override { return port_; }
  const HttpCounts& counts() const override { return shared_->counts; }
  std::size_t open_connections() const override { return shared_->open; }

 private:
  void run() {
    while (!context_->stopped()) {
      const Status status = guarded("a request failed", [this] { context_->run(); });
      if (!status.ok()) log(shared_->log, LogLevel::error, "page: " + status.message);
    }
  }

  static void end(HttpSession& session) {
    session.close();
    session.abandon();
  }

  void accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;  // the server goes
      if (error) {
        timer_.expires_after(kAcceptPause);
        return timer_.async_wait([this](error_code) { accept(); });
      }
      const Status status = guarded("a connection failed", [&] { take(std::move(socket)); });
      if (!status.ok()) log(shared_->log, LogLevel::error, "page: " + status.message);
      accept();
    });
  }

  void take(tcp::socket socket) {
    error_code error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return;
    socket.set_option(tcp::no_delay(true), error);
    ++shared_->counts.connections;
    auto& sessions = shared_->sessions;
    const auto gone = [](const auto& weak) { return weak.expired(); };
    sessions.remove_if(gone);
    shared_->refused.remove_if(gone);
    const Address address = address_of(peer);
    const bool full = make_room(address);
    if (shared_->open >= kMaxConnections + kMaxRefusedConnections) {
      ++shared_->counts.full;
      return;
    }
    const auto session = make_http_session(context_, shared_, std::move(socket), address);
    (full ? shared_->refused : sessions).push_back(session);
    if (full) return session->refuse_full();
    session->read();
  }

  /// Whether no connection gave way, though one had to.
  bool make_room(const Address& address) {
    auto& sessions = shared_->sessions;
    const auto same = [&](const auto& weak) {
      const auto session = weak.lock();
      return session && session->address() == address;
    };
    const bool many =
        static_cast<std::size_t>(std::ranges::count_if(sessions, same)) >= kMaxConnectionsOfAddress;
    if (!many && sessions.size() < kMaxConnections) return false;
    for (auto weak = sessions.begin(); weak != sessions.end(); ++weak) {  // the oldest first
      const auto session = weak->lock();
      if (!session || !session->gives_way() || (many && !same(*weak))) continue;
      ++shared_->counts.slow_requests;
      session->close();
      sessions.erase(weak);
      return false;
    }
    return true;
  }

  const std::shared_ptr<asio::io_context> context_ = std::make_shared<asio::io_context>(1);
  const std::shared_ptr<HttpShared> shared_;
  tcp::acceptor acceptor_;
  asio::steady_timer timer_;
  std::uint16_t port_ = 0;
  std::thread thread_;  ///< Last: uses what stands above.
};

}  // namespace

Result<std::unique_ptr<HttpServer>> HttpServer::create(const ListenAddress& listen, Access access,
                                                       Router router, LogHook log) {
  try {
    return std::unique_ptr<HttpServer>(std::make_unique<BeastServer>(
        listen, std::move(access), std::move(router), std::move(log)));
  } catch (const boost::system::system_error& error) {
    return unavailable("web.listen: ", listen.address, " port ", listen.port,
                       " cannot be listened on: ", error.code().message());
  }
}

}  // namespace bpa::server::web
