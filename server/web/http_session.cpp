// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Boost.Beast is private to this file. Every wait has a limit: a client that sends or reads too
// slowly loses its connection, and nothing is kept for it.
#include "server/web/http_session.hpp"

#include <chrono>
#include <limits>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"

namespace bpa::server::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using beast::error_code;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kMaxHeadBytes = 8192;  ///< As other servers have it.
constexpr std::uint64_t kLargeBody = 1 << 20;  ///< Of an upload.
constexpr std::size_t kMaxLargeBodies = 2;     ///< At a time: each may have 64 MB.
constexpr seconds kMaxHeadTime{10};   ///< From a connection, or the answer before, to a whole head.
constexpr seconds kMaxPauseTime{5};   ///< Between two parts of a body that is sent or read.
constexpr seconds kMaxBodyTime{60};   ///< For a whole body, either way.
constexpr seconds kMaxLingerTime{1};  ///< Until a refused client stops sending.
/// A connection that has sent no whole request for so long gives way to a new one.
constexpr seconds kPatience{1};

/// On every response. No script or style but the page's own files, no frames around it, no guessing
/// of types, no address given away.
constexpr std::pair<const char*, const char*> kHeaders[] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src "
     "'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-cache"},
};

class Session : public HttpSession, public std::enable_shared_from_this<Session> {
  using Message = http::response<http::span_body<const char>>;

  /// The member function as a handler that keeps this connection alive. What it throws ends the
  /// connection, not the process.
  auto on(void (Session::*member)(error_code, std::size_t)) {
    return [self = shared_from_this(), member](error_code error, std::size_t bytes) {
      const Status status =
          guarded("a connection failed", [&] { ((*self).*member)(error, bytes); });
      if (status.ok()) return;
      log(self->shared_->log, LogLevel::error, "page: " + status.message);
      self->close();
    };
  }

 public:
  Session(std::shared_ptr<asio::io_context> context, std::shared_ptr<HttpShared> shared,
          tcp::socket socket, const Address& address)
      : context_(context),
        shared_(std::move(shared)),
        stream_(std::move(socket)),
        buffer_(2 * kMaxHeadBytes),
        address_(address) {
    ++shared_->open;
  }
  ~Session() override {
    set_large(false);
    --shared_->open;
  }

  const Address& address() const override { return address_; }
  bool gives_way() const override { return waiting_ && Clock::now() - since_ > kPatience; }
  void close() override {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
  }

  void read() override {
    parser_.emplace();
    parser_->header_limit(kMaxHeadBytes);
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // until the head is known
    waiting_ = true;
    since_ = Clock::now();
    stream_.expires_after(kMaxHeadTime);
    http::async_read_header(stream_, buffer_, *parser_, on(&Session::on_head));
  }

  void refuse_full() override {
    ++shared_->counts.full;
    answer(refusal(503, Status(StatusCode::busy,
                               "as many connections are open as may be; try again later")),
           true);
  }

  void abandon() override { kept_.reset(); }

 private:
  void answer(Response response, bool last) {
    response_ = std::move(response);
    const std::string_view body = response_.body ? *response_.body : response_.fixed;
    message_ = {};
    message_.result(static_cast<unsigned>(response_.status));
    for (const auto& [name, value] : kHeaders) message_.set(name, value);
    message_.set(http::field::content_type, response_.type);
    if (response_.zipped) message_.set(http::field::content_encoding, "gzip");
    if (response_.status == 429 || response_.status == 503) {
      message_.set(http::field::retry_after, "1");
    }
    if (!response_.file_name.empty()) {
      message_.set(http::field::content_disposition,
                   "attachment; filename=\"" + response_.file_name + "\"");
    }
    last_ = last || !keep_alive_;
    message_.keep_alive(!last_);
    message_.body() = beast::span<const char>(body.data(), body.size());
    message_.content_length(body.size());
    serializer_.emplace(message_);
    deadline_ = Clock::now() + kMaxBodyTime;
    ++shared_->counts.requests;
    write();
    kept_.reset();
  }

  void fail(error_code error) {
    if (error == beast::error::timeout) {
      if (parser_->got_some()) ++shared_->counts.slow_requests;  // else it only stays open
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      ++shared_->counts.malformed;
      keep_alive_ = false;
      return answer(refusal(400, invalid_argument("this is no HTTP request: " + error.message())),
                    true);
    }
    close();
  }

  void on_head(error_code error, std::size_t) {
    waiting_ = false;
    if (error) return fail(error);
    const auto& message = parser_->get();
    keep_alive_ = message.keep_alive();
    request_ = {};
    request_.method = std::string(message.method_string());
    request_.address = address_;
    const auto field = [&message](auto name) { return std::string(message[name]); };
    request_.host = field(http::field::host);
    request_.origin = field(http::field::origin);
    request_.fetch_site = field("Sec-Fetch-Site");
    request_.authorization = field(http::field::authorization);
    request_.body_bytes = parser_->content_length().value_or(0);
    const std::string_view text(message.target().data(), message.target().size());
    Result<Target> target = parse_target(text);
    if (!target.ok()) return refuse(Refusal::path, refusal(target.status()));
    request_.path = std::move(target->path);
    Result<Route> route = shared_->router(request_);
    const Right right = route.ok() ? route->right : Right::token;
    if (const auto refused = shared_->access.check(request_, right)) {
      return refuse(refused->cause, refusal(refused->status, refused->why));
    }
    auto query = parse_query(target->query);
    if (!query.ok()) return refuse(Refusal::path, refusal(query.status()));
    request_.query = std::move(query).value();
    if (request_.method != "GET" && request_.method != "POST") {
      return refuse(Refusal::method,
                    refusal(405, invalid_argument("the method is ", request_.method,
                                                  "; it must be GET or POST")));
    }
    if (!route.ok()) return refuse(Refusal::path, refusal(route.status()));
    route_ = std::move(route).value();
    if (request_.body_bytes > route_.max_body) return refuse_size();
    if (parser_->chunked()) {
      return refuse(Refusal::size, refusal(411, invalid_argument("the body is sent in chunks; it "
                                                                 "must have a Content-Length")));
    }
    if (request_.body_bytes > kLargeBody && shared_->large_bodies >= kMaxLargeBodies) {
      return refuse(Refusal::busy, refusal(Status(StatusCode::busy,
                                                  "another upload is under way; try again later")));
    }
    set_large(request_.body_bytes > kLargeBody);
    parser_->body_limit(route_.max_body);
    if (field(http::field::expect) == "100-continue") {  // curl waits for a second otherwise
      static const std::string kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
      error_code ignored;
      stream_.socket().write_some(asio::buffer(kContinue), ignored);
    }
    deadline_ = Clock::now() + kMaxBodyTime;
    on_body({}, 0);
  }

  /// Notes whether this connection's request has a large body.
  void set_large(bool large) {
    if (large == large_) return;
    large_ = large;
    shared_->large_bodies += large ? 1 : -1;
  }

  void refuse_size() {
    refuse(Refusal::size,
           refusal(413, invalid_argument("the body has more than ", route_.max_body,
                                         " bytes; send no more to ", request_.path)));
  }

  void on_body(error_code error, std::size_t) {
    if (error == http::error::body_limit) return refuse_size();
    if (error) return fail(error);
    if (!parser_->is_done()) {
      if (Clock::now() > deadline_) return fail(beast::error::timeout);
      stream_.expires_after(kMaxPauseTime);
      return http::async_read_some(stream_, buffer_, *parser_, on(&Session::on_body));
    }
    request_.body = std::move(parser_->get().body());
    stream_.expires_never();
    kept_ = shared_from_this();
    route_.serve(std::move(request_), responder());
  }

  /// The server may be gone when it is called, or the connection.
  Responder responder() {
    return [context = context_, weak = weak_from_this()](Response response) {
      asio::post(*context, [weak, response = std::move(response)]() mutable {
        if (const auto self = weak.lock()) self->answer(std::move(response), false);
      });
    };
  }

  void refuse(Refusal cause, Response response) {
    ++shared_->counts.refused[static_cast<std::size_t>(cause)];
    // A body that was not read would be taken for the next request.
    answer(std::move(response), request_.body_bytes > 0 || parser_->chunked());
  }

  void write() {
    stream_.expires_after(kMaxPauseTime);
    http::async_write_some(stream_, *serializer_, on(&Session::on_written));
  }

  void on_written(error_code error, std::size_t) {
    if (error == beast::error::timeout || Clock::now() > deadline_) ++shared_->counts.slow_readers;
    if (error || Clock::now() > deadline_) return close();
    if (!serializer_->is_done()) return write();
    serializer_.reset();
    response_ = {};
    set_large(false);
    if (!last_) return read();
    // Closing with bytes unread would take the answer away from the client.
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kMaxLingerTime);
    drain();
  }

  void drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kMaxHeadBytes), on(&Session::on_drained));
  }
  void on_drained(error_code error, std::size_t) {
    if (error) return close();
    drain();
  }

  const std::shared_ptr<asio::io_context> context_;  ///< Outlives the stream.
  const std::shared_ptr<HttpShared> shared_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  const Address address_;
  boost::optional<http::request_parser<http::string_body>> parser_;
  Request request_;
  Route route_;  ///< Of request_.
  bool keep_alive_ = false;
  bool large_ = false;  ///< Its request has a large body.
  bool waiting_ = false;
  Clock::time_point since_, deadline_;
  Response response_;  ///< Holds the bytes of message_.
  Message message_;
  boost::optional<http::response_serializer<http::span_body<const char>>> serializer_;
  bool last_ = false;
  std::shared_ptr<Session> kept_;  ///< Itself, while it waits for an answer and for nothing else.
};

}  // namespace

std::shared_ptr<HttpSession> make_http_session(std::shared_ptr<asio::io_context> context,
                                               std::shared_ptr<HttpShared> shared,
                                               tcp::socket socket, const Address& address) {
  return std::make_shared<Session>(std::move(context), std::move(shared), std::move(socket),
                                   address);
}

}  // namespace bpa::server::web
