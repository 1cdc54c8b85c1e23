// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/page.hpp"

#include <utility>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "server/services/request_thread.hpp"
#include "server/web/access.hpp"
#include "server/web/http_server.hpp"

namespace bpa::server::web {
namespace {

/// A viewer asks for ten things at once when it opens the page.
constexpr std::size_t kMaxWaitingCalls = 256;

class OpenPage : public Page {
 public:
  OpenPage(const WebOptions& options, PageLinks links, Feed& feed, const RecentLog& log)
      : feed_(feed),
        log_(links.context.log),
        api_(std::move(links), feed, log),
        listen_(or_throw(parse_listen(options.listen))),
        calls_(kMaxWaitingCalls) {
    std::string token;
    if (!options.token_file.empty()) {
      token = or_throw(read_token(options.token_file));
    } else if (!listen_.is_loopback()) {
      token = shown_token_ = make_token();
    }
    server_ = or_throw(HttpServer::create(
        listen_, Access(listen_, token, options.hosts),
        [this](const RequestHead& head) { return api_.route(head, take_turn_); }, log_));
  }

  std::string address() const override {
    return concat("http://", listen_.host(), ":", server_->port(), "/",
                  shown_token_.empty() ? "" : "#token=", shown_token_);
  }

  SourceReport report() override {
    feed_.tidy();
    const FeedCounts feed = feed_.counts();
    const HttpCounts& http = server_->counts();
    SourceReport report{SourceReport::kOk,
                        "web",
                        concat(feed.viewers, feed.viewers == 1 ? " viewer" : " viewers"),
                        concat(listen_.address, " port ", server_->port()),
                        {}};
    const auto add = [&report](const std::string& name, std::uint64_t count) {
      report.values.push_back({"web: " + name, std::to_string(count)});
    };
    add("viewers", feed.viewers);
    add("viewers that left or stopped reading", feed.viewers_gone);
    add("camera frames that no viewer saw", feed.frames_unseen);
    add("connections now", server_->open_connections());
    add("connections", http.connections);
    add("connections refused, as many were open as may be", http.full);
    add("connections cut off, sent too slowly", http.slow_requests);
    add("connections cut off, read too slowly", http.slow_readers);
    add("requests answered", http.requests);
    add("requests that were no HTTP", http.malformed);
    for (std::size_t i = 0; i < kRefusals; ++i) {
      add(std::string("requests refused: ") + kRefusalNames[i], http.refused[i]);
    }
    return report;
  }

  const Busy& busy() const override { return calls_.busy(); }

 private:
  Feed& feed_;
  const LogHook log_;
  Api api_;
  const ListenAddress listen_;
  std::string shown_token_;  ///< Empty where none was made.
  RequestThread calls_;
  /// On the thread of the server: requests have their turns on another one.
  const Api::TakeTurn take_turn_ = [this](const wire::Guid& client, std::function<void()> call,
                                          const Responder& respond) {
    calls_.push(client, {[call = std::move(call), respond] {
                           const Status status = guarded("the request failed", call);
                           if (!status.ok()) respond(refusal(status));
                         },
                         [respond](const Status& status) { respond(refusal(status)); }});
  };
  std::unique_ptr<HttpServer> server_;  ///< Last: it calls what stands above.
};

}  // namespace

std::unique_ptr<Page> open_page(const WebOptions& options, PageLinks links, Feed& feed,
                                const RecentLog& log) {
  return std::make_unique<OpenPage>(options, std::move(links), feed, log);
}

}  // namespace bpa::server::web
