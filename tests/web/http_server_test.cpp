// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/http_server.hpp"

#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/http_client.hpp"
#include "tests/support/latest.hpp"

// A server in this process, and clients that send the bytes that they like.

namespace bpa::server::web {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using support::Connection;
using support::http_request;
using support::HttpAnswer;
using Clock = std::chrono::steady_clock;

class WebServer : public testing::Test {
 protected:
  explicit WebServer(const std::string& token = "") {
    const auto handle = [this](Request&& request, Responder respond) {
      if (request.path == "/never") return kept.add(respond);
      if (request.path == "/much") {
        return respond(bytes_response(std::make_shared<const std::string>(40 << 20, 'x'), "x"));
      }
      respond(json_response("{\"bytes\":" + std::to_string(request.body.size()) + "}"));
    };
    const auto route = [handle](const RequestHead& head) -> Result<Route> {
      if (head.path == "/small") return Route{.max_body = 1000, .serve = handle};
      if (head.path == "/large") return Route{.max_body = 64 << 20, .serve = handle};
      if (head.path == "/throws") throw std::runtime_error("a bug");
      if (head.path == "/") return Route{.right = Right::everyone, .serve = handle};
      if (head.path == "/much" || head.path == "/never") return Route{.serve = handle};
      return not_found("there is no such path");
    };
    auto made =
        HttpServer::create({"127.0.0.1", 0}, Access({"127.0.0.1", 0}, token, {}), route, {});
    EXPECT_TRUE(made.ok()) << made.status().message;
    server = std::move(made).value();
  }

  HttpAnswer ask(const std::string& method, const std::string& path, const std::string& body = "",
                 const std::map<std::string, std::string>& headers = {}) {
    return support::http(server->port(), method, path, body, headers);
  }
  std::uint64_t refused(Refusal cause) const {
    return server->counts().refused[static_cast<std::size_t>(cause)];
  }
  bool becomes(const std::function<bool()>& condition, seconds time) const {
    const auto end = Clock::now() + time;
    while (!condition() && Clock::now() < end) std::this_thread::sleep_for(milliseconds(20));
    return condition();
  }

  support::Latest<Responder> kept;  ///< Of the thread of the server, too.
  std::unique_ptr<HttpServer> server;
};

TEST_F(WebServer, AnswersAndKeepsTheConnection) {
  Connection connection(server->port());
  for (int i = 0; i < 3; ++i) {
    connection.send(http_request("POST", "/small", std::string(100, 'a')));
    const HttpAnswer answer = connection.answer();
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, "{\"bytes\":100}");
    EXPECT_EQ(answer.headers.at("x-content-type-options"), "nosniff");
    EXPECT_NE(answer.headers.at("content-security-policy").find("default-src 'none'"),
              std::string::npos);
  }
  EXPECT_EQ(server->counts().connections, 1U);
}

TEST_F(WebServer, RefusesWithOneSentence) {
  const struct {
    const char* method;
    const char* path;
    std::map<std::string, std::string> headers;
    std::size_t body;
    int status;
    Refusal cause;
  } cases[] = {
      {"GET", "/", {{"Host", "evil.com"}}, 0, 403, Refusal::host},
      {"GET", "/", {{"Origin", "http://evil.com"}}, 0, 403, Refusal::origin},
      {"GET", "/../../etc/passwd", {}, 0, 404, Refusal::path},
      {"GET", "/%2e%2e/%2e%2e/etc/passwd", {}, 0, 404, Refusal::path},
      {"GET", "/small/../large", {}, 0, 404, Refusal::path},
      {"GET", "//etc/passwd", {}, 0, 404, Refusal::path},
      {"GET", "/?a=%zz", {}, 0, 400, Refusal::path},
      {"PUT", "/small", {}, 3, 405, Refusal::method},
      {"DELETE", "/", {}, 0, 405, Refusal::method},
      {"POST", "/small", {}, 1001, 413, Refusal::size},
      {"POST", "/", {}, 1, 413, Refusal::size},
  };
  for (const auto& c : cases) {
    const std::uint64_t before = refused(c.cause);
    const HttpAnswer answer = ask(c.method, c.path, std::string(c.body, 'a'), c.headers);
    EXPECT_EQ(answer.status, c.status) << c.method << ' ' << c.path;
    EXPECT_NE(answer.body.find("\"message\":\""), std::string::npos) << answer.body;
    EXPECT_EQ(refused(c.cause), before + 1) << c.method << ' ' << c.path;
  }
}

class GuardedWebServer : public WebServer {
 protected:
  GuardedWebServer() : WebServer("0123456789abcdef") {}
  int status_of(const std::string& target, const std::string& authorization = "") const {
    Connection connection(server->port());
    connection.send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" +
                    (authorization.empty() ? "" : "Authorization: " + authorization + "\r\n") +
                    "\r\n");
    return connection.answer().status;
  }
};

// RFC 9112, 3.2: absolute-form, authority-form and asterisk-form are for proxies and OPTIONS.
TEST_F(GuardedWebServer, TakesTargetsOfOriginFormAlone) {
  const std::string bearer = "Bearer 0123456789abcdef";
  for (const char* target : {"Xmuch", "much", "*", "http://localhost/much", "localhost:80", "?a=1",
                             "%2Fmuch", "./much", "\\much", "/much#x",
                             "/mu\x01"
                             "ch",
                             "/m\xc3\xbc"
                             "ch"}) {
    EXPECT_EQ(status_of(target), 400) << target;
    EXPECT_EQ(status_of(target, bearer), 400) << target;
  }
}

TEST_F(GuardedWebServer, RefusesWhatDeclaresNoRight) {
  EXPECT_EQ(status_of("/"), 200);
  EXPECT_EQ(status_of("/?token=1"), 200);
  // What there is not is refused like what there is, so that a stranger learns nothing.
  for (const char* target : {"/much", "//much", "/nothing", "/much/", "/%6duch", "/..;/much"}) {
    EXPECT_EQ(status_of(target), 401) << target;
  }
  EXPECT_EQ(status_of("/much", "Bearer 0123456789abcdef"), 200);
  EXPECT_EQ(status_of("/nothing", "Bearer 0123456789abcdef"), 404);
}

TEST_F(WebServer, RefusesABodyBeforeItIsSent) {
  Connection connection(server->port());
  connection.send("POST /large HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\n");
  EXPECT_EQ(connection.answer().status, 413);
  Connection chunked(server->port());
  chunked.send("POST /large HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n");
  EXPECT_EQ(chunked.answer().status, 411);
}

TEST_F(WebServer, LetsFewLargeBodiesInAtATime) {
  std::vector<std::unique_ptr<Connection>> uploads;
  for (int i = 0; i < 3; ++i) {
    uploads.push_back(std::make_unique<Connection>(server->port()));
    uploads.back()->send(
        "POST /large HTTP/1.1\r\nHost: localhost\r\nContent-Length: 50000000\r\n\r\nbegun");
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_EQ(uploads[2]->answer().status, 503);
  uploads.erase(uploads.begin());  // one is given up: its place is free again
  EXPECT_TRUE(becomes(
      [&] { return ask("POST", "/large", std::string(2 << 20, 'a')).status == 200; }, seconds(5)));
}

TEST_F(WebServer, AnswersWhatIsNoHttp) {
  const std::string cases[] = {"hello\r\n\r\n", "GET\r\n\r\n", std::string(300, '\0') + "\r\n\r\n",
                               "GET / HTTP/1.1\r\nHost: " + std::string(20000, 'a') + "\r\n\r\n",
                               "\x16\x03\x01\x02 TLS hello\r\n\r\n"};
  for (const std::string& bytes : cases) {
    Connection connection(server->port());
    connection.send(bytes);
    EXPECT_EQ(connection.answer().status, 400) << bytes.substr(0, 20);
  }
  EXPECT_EQ(server->counts().malformed, std::size(cases));
  EXPECT_EQ(ask("GET", "/").status, 200);
}

TEST_F(WebServer, SurvivesAHandlerThatThrows) {
  EXPECT_EQ(ask("GET", "/throws").status, 0);  // the connection ends
  EXPECT_EQ(ask("GET", "/").status, 200);
}

TEST_F(WebServer, CutsOffWhoSendsSlowly) {
  Connection slow(server->port());
  const auto begun = Clock::now();
  slow.send("GET / HTTP/1.1\r\nHost: localhost\r\n");
  while (slow.send("X-Slow: a\r\n") && Clock::now() - begun < seconds(20)) {
    if (slow.receive(milliseconds(500)).empty() && slow.ended()) break;
  }
  EXPECT_LT(Clock::now() - begun, seconds(13));  // kMaxHeadTime is 10 s
  // The socket is closed a moment before that is counted.
  EXPECT_TRUE(becomes([this] { return server->counts().slow_requests == 1; }, seconds(2)));
}

TEST_F(WebServer, CutsOffWhoDoesNotRead) {
  Connection lazy(server->port());
  lazy.send(http_request("GET", "/much"));
  EXPECT_TRUE(becomes([this] { return server->counts().slow_readers == 1; }, seconds(8)));
  EXPECT_TRUE(becomes([this] { return server->open_connections() == 0; }, seconds(2)));
}

TEST_F(WebServer, AThousandConnectionsDoNotKeepOthersOut) {
  std::vector<std::unique_ptr<Connection>> crowd;
  for (int i = 0; i < 1000; ++i) crowd.push_back(std::make_unique<Connection>(server->port()));
  EXPECT_TRUE(becomes([this] { return server->counts().connections >= 900; }, seconds(10)));
  EXPECT_LE(server->open_connections(), 128U + 64U);
  // Each was told so, or closed, or still stands among those that may.
  int told = 0, closed = 0, open = 0;
  for (const auto& connection : crowd) {
    const std::string answer = connection->receive(milliseconds(0));
    told += answer.starts_with("HTTP/1.1 503") ? 1 : 0;
    closed += answer.empty() && connection->ended() ? 1 : 0;
    open += answer.empty() && !connection->ended() ? 1 : 0;
  }
  EXPECT_GT(told, 0);
  EXPECT_LE(open, 64 + 64 + 64);  // of one address, and what the kernel has not handed over
  EXPECT_EQ(told + closed + open, 1000);
  // After a second those that send nothing give way, though all still stand. While the kernel's
  // queue is full, TCP tries again after 1, 3 and 7 s.
  EXPECT_TRUE(becomes([this] { return ask("GET", "/").status == 200; }, seconds(8)));
}

TEST_F(WebServer, MayGoBeforeItsAnswersCome) {
  Connection waiting(server->port());
  waiting.send(http_request("GET", "/never"));
  const auto respond = kept.wait_for([](const Responder&) { return true; }, seconds(5));
  ASSERT_TRUE(respond);
  server.reset();
  (*respond)(json_response("{}"));  // nobody is there any more
  EXPECT_EQ(waiting.answer(seconds(1)).status, 0);
}

TEST(HttpServer, SaysThatAPortIsTaken) {
  auto first = HttpServer::create({"127.0.0.1", 0}, Access({}, "", {}), {}, {});
  ASSERT_TRUE(first.ok());
  const auto second =
      HttpServer::create({"127.0.0.1", (*first)->port()}, Access({}, "", {}), {}, {});
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.status().message.find("in use"), std::string::npos) << second.status().message;
}

}  // namespace
}  // namespace bpa::server::web
