// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/supervision.hpp"

#include <chrono>
#include <cstdlib>
#include <future>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/http_client.hpp"
#include "tests/support/notify_socket.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

// A server under systemd, which is played by a socket here.

namespace bpa {
namespace {

namespace msgs = wire::bpa_msgs;
using std::chrono::milliseconds;

/// What systemd sets for the processes that start while this lives.
class Systemd {
 public:
  explicit Systemd(const char* watchdog_usec) : socket_(path()) {
    setenv("NOTIFY_SOCKET", path().c_str(), 1);
    setenv("WATCHDOG_USEC", watchdog_usec, 1);
  }
  ~Systemd() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    unlink(path().c_str());
  }
  std::string receive() { return socket_.receive(); }

 private:
  static std::string path() { return support::scratch_folder() + "/notify"; }
  support::NotifySocket socket_;
};

msgs::Detect_Request request() {
  msgs::Detect_Request request;
  request.has_frame = true;
  request.frame = support::wall_frame();
  return request;
}

/// Of the page of a server that has started; 0 when it does not within 20 s.
int page_port(const support::StubServer& server) {
  const std::string before = "page: http://127.0.0.1:";
  for (int i = 0; i < 200; ++i) {
    const std::string log = server.log();
    const std::size_t at = log.find(before);
    if (at != log.npos) return std::atoi(log.c_str() + at + before.size());
    std::this_thread::sleep_for(milliseconds(100));
  }
  return 0;
}

TEST(Supervision, SystemdLearnsOfStartLifeAndEnd) {
  Systemd systemd("200000");
  support::StubServer server;
  EXPECT_EQ(systemd.receive(), "READY=1\nSTATUS=serving") << server.log();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(systemd.receive(), "WATCHDOG=1");
  server.process().signal(SIGTERM);
  std::string last = "WATCHDOG=1";
  while (last == "WATCHDOG=1") last = systemd.receive();
  EXPECT_EQ(last, "STOPPING=1\nSTATUS=stopping");
  EXPECT_EQ(server.process().wait(milliseconds(10000)), 0) << server.log();
}

// What the server ends first is not used by the threads that it ends later.
TEST(Supervision, AServerEndsInOrderWhileItIsAskedForItsStatus) {
  support::StubServer server({"web.listen=0"});
  const int port = page_port(server);
  ASSERT_NE(port, 0) << server.log();
  auto participant = support::test_participant("tester");
  auto get_status = wire::ServiceClient<msgs::GetStatus>::create(*participant, "get_status");
  ASSERT_TRUE(get_status.ok());
  ASSERT_TRUE(get_status->wait_for_service(milliseconds(10000))) << server.log();
  const std::jthread client([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) (void)get_status->call({}, milliseconds(1000));
  });
  const std::jthread viewer([port](const std::stop_token& stop) {
    while (!stop.stop_requested()) (void)support::http(port, "GET", "/api/health");
  });
  std::this_thread::sleep_for(milliseconds(500));
  server.process().signal(SIGTERM);
  EXPECT_EQ(server.process().wait(milliseconds(20000)), 0) << server.log();
}

// A search takes a minute and counts as hung after a second.
TEST(Supervision, AServerThatHangsSaysSoAnswersAndEnds) {
  Systemd systemd("400000");
  support::StubServer server({"detection.hang_s=1"}, 60000);
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  std::mutex mutex;
  std::string detection;  // what /diagnostics said of it last
  const auto diagnostics = wire::Subscriber<wire::diagnostic_msgs::DiagnosticArray>::create(
      *participant, "diagnostics", {.qos = wire::qos::results()},
      [&](wire::diagnostic_msgs::DiagnosticArray&& array, const wire::SampleMeta&) {
        const std::lock_guard<std::mutex> lock(mutex);
        detection = array.status.at(0).message;
      });
  ASSERT_TRUE(diagnostics.ok());
  auto detect = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
  ASSERT_TRUE(detect.ok());
  ASSERT_TRUE(detect->wait_for_service(milliseconds(10000))) << server.log();
  ASSERT_TRUE(diagnostics->wait_for_matched(milliseconds(10000)));
  const auto call = [&] { return detect->call(request(), milliseconds(50000)); };
  auto hangs = std::async(std::launch::async, call);
  auto waits = std::async(std::launch::async, call);
  const auto answers = {hangs.get(), waits.get()};
  int refused = 0, gone = 0;
  for (const auto& answer : answers) {
    gone += answer.status().code == StatusCode::unavailable ? 1 : 0;
    if (!answer.ok()) continue;
    EXPECT_NE(answer->status.message.find("hangs"), std::string::npos) << answer->status.message;
    ++refused;
  }
  EXPECT_EQ(refused, 1);  // that which waited behind the search
  EXPECT_EQ(gone, 1);     // that which is searched
  EXPECT_EQ(server.process().wait(milliseconds(20000)), server::kExitHung) << server.log();
  EXPECT_NE(server.log().find("the search of a request's frame has not returned"),
            std::string::npos)
      << server.log();
  std::string last = systemd.receive();
  while (last == "WATCHDOG=1" || last.rfind("READY=1", 0) == 0) last = systemd.receive();
  EXPECT_EQ(last.rfind("STOPPING=1\nSTATUS=the search of a request's frame", 0), 0U) << last;
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_NE(detection.find("it hangs"), std::string::npos) << detection;
}

// What the server takes away when it leaves is not used by the threads of its page.
TEST(Supervision, AServerThatHangsEndsInOrderWhileViewersLook) {
  support::StubServer server({"detection.hang_s=1", "web.listen=0"}, 60000);
  const int port = page_port(server);
  ASSERT_NE(port, 0) << server.log();
  auto participant = support::test_participant("tester");
  auto detect = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
  const std::jthread viewer([port](const std::stop_token& stop) {
    while (!stop.stop_requested()) (void)support::http(port, "GET", "/api/health");
  });
  const auto answer = detect->call(request(), milliseconds(50000));
  EXPECT_EQ(answer.status().code, StatusCode::unavailable) << server.log();
  EXPECT_EQ(server.process().wait(milliseconds(20000)), server::kExitHung) << server.log();
}

TEST(Supervision, ALongSearchThatMayTakeItsTimeDoesNotHang) {
  support::StubServer server({"detection.hang_s=0"}, 1500);
  auto participant = support::test_participant("tester");
  auto detect = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
  const auto answer = detect->call(request(), milliseconds(30000));
  ASSERT_TRUE(answer.ok()) << answer.status().message << server.log();
  EXPECT_TRUE(answer->success) << answer->status.message;
}

}  // namespace
}  // namespace bpa
