// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/access.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/process.hpp"

namespace bpa::server::web {
namespace {

using std::chrono::seconds;

TEST(ParseListen, AloneAPortIsForThisMachine) {
  const struct {
    const char* text;
    const char* address;
    int port;
    bool loopback;
  } cases[] = {{"8080", "127.0.0.1", 8080, true},
               {"0", "127.0.0.1", 0, true},
               {"0.0.0.0:80", "0.0.0.0", 80, false},
               {"[::1]:8080", "::1", 8080, true},
               {"[::]:1", "::", 1, false},
               {"localhost:9", "127.0.0.1", 9, true},
               {"127.0.0.2:65535", "127.0.0.2", 65535, true}};
  for (const auto& c : cases) {
    const auto listen = parse_listen(c.text);
    ASSERT_TRUE(listen.ok()) << listen.status().message;
    EXPECT_EQ(listen->address, c.address);
    EXPECT_EQ(listen->port, c.port);
    EXPECT_EQ(listen->is_loopback(), c.loopback) << c.text;
  }
  for (const char* wrong : {"", "x", "70000", "-1", "80x", "robot.local:80", ":80", "1.2.3:80"}) {
    const auto listen = parse_listen(wrong);
    ASSERT_FALSE(listen.ok()) << wrong;
    EXPECT_NE(listen.status().message.find("ADDRESS:PORT"), std::string::npos);
  }
}

TEST(ParseListen, TheHostOfThePageIsOneThatOthersCanOpen) {
  char name[256] = {};
  ASSERT_EQ(gethostname(name, sizeof name - 1), 0);
  EXPECT_EQ(parse_listen("0.0.0.0:80")->host(), name);
  EXPECT_EQ(parse_listen("[::]:80")->host(), name);
  EXPECT_EQ(parse_listen("[::1]:80")->host(), "[::1]");
  EXPECT_EQ(parse_listen("192.168.1.5:80")->host(), "192.168.1.5");
}

TEST(Token, IsRandomAndLong) {
  const std::string a = make_token(), b = make_token();
  EXPECT_EQ(a.size(), 32U);
  EXPECT_NE(a, b);
}

class TokenFile : public testing::Test {
 protected:
  Result<std::string> read(const std::string& text, mode_t mode) {
    const std::string path = support::scratch_folder() + "/token";
    std::ofstream(path) << text;
    chmod(path.c_str(), mode);
    return read_token(path);
  }
};

TEST_F(TokenFile, IsReadByItsOwnerAlone) {
  const auto token = read("abcdefghij0123456789\nmore", 0600);
  ASSERT_TRUE(token.ok()) << token.status().message;
  EXPECT_EQ(*token, "abcdefghij0123456789");
  EXPECT_TRUE(read("abcdefghij0123456789", 0400).ok());
  for (const mode_t mode : {0640U, 0604U, 0666U, 0610U}) {
    const auto refused = read("abcdefghij0123456789", mode);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.status().message.find("0600"), std::string::npos);
  }
}

TEST_F(TokenFile, RefusesShortAndStrangeTokens) {
  for (const char* text : {"", "short", "has blanks in it here", "<script>alert(1)</script>"}) {
    EXPECT_FALSE(read(text, 0600).ok()) << text;
  }
  EXPECT_EQ(read_token("/nowhere/token").status().code, StatusCode::not_found);
}

RequestHead head_of(const std::string& host, const std::string& path = "/api/models") {
  RequestHead head;
  head.method = "GET";
  head.path = path;
  head.host = host;
  return head;
}

/// The cause of a refusal; nothing where the request may go on.
std::optional<Refusal> cause(Access& access, const RequestHead& head, Right right = Right::token) {
  const auto refused = access.check(head, right);
  return refused ? std::optional(refused->cause) : std::nullopt;
}

TEST(Access, OfLoopbackTakesNamesOfThisMachineAlone) {
  Access access({"127.0.0.1", 8080}, "", {"Robot.local"});
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080", "LOCALHOST",
                           "localhost:9000", "robot.local:8080"}) {
    EXPECT_EQ(cause(access, head_of(host)), std::nullopt) << host;
  }
  for (const char* host : {"", "evil.com", "localhost.evil.com", "192.168.1.7:8080",
                           "127.0.0.1.evil.com:8080", "[::2]:8080"}) {
    EXPECT_EQ(cause(access, head_of(host)), Refusal::host) << host;
  }
}

TEST(Access, OfOtherAddressesTakesNumbers) {
  Access access({"0.0.0.0", 8080}, "", {});
  EXPECT_EQ(cause(access, head_of("192.168.1.7:8080")), std::nullopt);
  EXPECT_EQ(cause(access, head_of("[fe80::1]:8080")), std::nullopt);
  EXPECT_EQ(cause(access, head_of("rebound.evil.com:8080")), Refusal::host);
}

TEST(Access, RefusesOtherSites) {
  Access access({"127.0.0.1", 8080}, "", {});
  RequestHead head = head_of("localhost:8080");
  head.origin = "http://localhost:8080";
  head.fetch_site = "same-origin";
  EXPECT_EQ(cause(access, head), std::nullopt);
  for (const char* origin : {"http://evil.com", "null", "http://localhost:8081",
                             "http://localhost:8080.evil.com", "file://"}) {
    head.origin = origin;
    EXPECT_EQ(cause(access, head), Refusal::origin) << origin;
  }
  head.origin = "";
  for (const char* site : {"cross-site", "same-site"}) {
    head.fetch_site = site;
    EXPECT_EQ(cause(access, head), Refusal::origin) << site;
  }
}

TEST(Access, NeedsTheWholeToken) {
  Access access({"0.0.0.0", 8080}, "0123456789abcdef", {});
  RequestHead head = head_of("10.0.0.1:8080");
  for (const char* wrong :
       {"", "0123456789abcdef", "Bearer", "Bearer ", "Bearer 0123456789abcde",
        "Bearer 0123456789abcdef0", "Bearer 0123456789abcdeF", "Basic 0123456789abcdef"}) {
    head.authorization = wrong;
    const auto refused = access.check(head, Right::token);
    ASSERT_TRUE(refused) << wrong;
    EXPECT_EQ(refused->cause, Refusal::token);
    EXPECT_EQ(refused->status, 401);
    EXPECT_EQ(refused->why.message.find("0123456789abcdef"), std::string::npos);
  }
  head.authorization = "Bearer 0123456789abcdef";
  EXPECT_EQ(cause(access, head), std::nullopt);
  // Whatever its path says, the route decides.
  for (const char* path : {"/", "api/models", "/page.css"}) {
    EXPECT_EQ(cause(access, head_of("10.0.0.1:8080", path)), Refusal::token) << path;
    EXPECT_EQ(cause(access, head_of("10.0.0.1:8080", path), Right::everyone), std::nullopt);
  }
}

TEST(Access, LimitsTheRequestsOfEachAddress) {
  Access access({"127.0.0.1", 8080}, "", {});
  const Access::Clock::time_point start{};
  RequestHead head = head_of("localhost");
  const auto allowed = [&](int count, Access::Clock::time_point now) {
    int passed = 0;
    for (int i = 0; i < count; ++i) passed += access.check(head, Right::token, now) ? 0 : 1;
    return passed;
  };
  EXPECT_EQ(allowed(1000, start), 600);  // the burst
  EXPECT_EQ(allowed(1000, start + seconds(1)), 300);
  const auto refused = access.check(head, Right::token, start + seconds(1));
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, 429);
  head.address[15] = 1;  // another one is not concerned
  EXPECT_EQ(allowed(10, start + seconds(1)), 10);
}

}  // namespace
}  // namespace bpa::server::web
