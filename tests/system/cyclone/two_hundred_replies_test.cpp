// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/service.hpp"
#include "tests/support/cyclone.hpp"
#include "tests/support/stub_server.hpp"

// 200 requests in both framings while bad clients misbehave: every one is answered.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Unload = wire::bpa_msgs::UnloadModel;

/// Requests that no server can read, in either framing, until told to stop.
class Vandal {
 public:
  Vandal()
      : participant_(support::test_participant("vandal").value()),
        writer_(wire::detail::make_writer(
                    participant_, wire::detail::endpoint_spec<wire::bpa_msgs::UnloadModel_Request>(
                                      "rq" + support::test_namespace() + "/unload_modelRequest",
                                      wire::qos::services()))
                    .value()),
        thread_([this] { run(); }) {}
  ~Vandal() {
    stop_ = true;
    thread_.join();
  }
  int sent() const { return sent_; }

 private:
  void run() {
    const std::vector<std::vector<std::uint8_t>> requests = {
        {0, 1, 0, 0},                                         // a header and nothing
        {0, 1, 0, 0, 0xff, 0xff, 0xff, 0x7f, 'x', 0},         // a name of 2 GB
        {7, 7, 7, 7, 7, 7, 7, 7},                             // no CDR
        {0, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12},  // half a header of Cyclone's
        // Cyclone's header and a name of 4 GB.
        {0, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 1, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 'x'}};
    wire::SampleId nobody;
    nobody.writer.fill(0x44);
    for (std::size_t i = 0; !stop_; ++i) {
      const auto bytes = wire::detail::bytes_ref(requests[i % requests.size()]);
      // With a related identity it is in Fast DDS's framing, without in Cyclone's.
      const wire::SampleId* related = i % 2 == 0 ? &nobody : nullptr;
      if (writer_->write(bytes, related, nullptr).ok()) ++sent_;
      std::this_thread::sleep_for(milliseconds(10));
    }
  }

  wire::Participant participant_;
  std::unique_ptr<wire::detail::RawWriter> writer_;
  std::atomic<bool> stop_{false};
  std::atomic<int> sent_{0};
  std::thread thread_;
};

/// Calls of new clients of ours, `each` by every one; how many were answered.
int call_as_fast_dds(int clients, int each) {
  int answered = 0;
  for (int i = 0; i < clients; ++i) {
    auto participant = support::test_participant("caller");
    const auto client = wire::ServiceClient<Unload>::create(*participant, "unload_model");
    for (int call = 0; call < each; ++call) {
      const auto response = client->call({"model " + std::to_string(call)}, seconds(5));
      // The stub cannot unload anything: it says so, and that is an answer.
      answered += response.ok() && !response->success ? 1 : 0;
      EXPECT_TRUE(response.ok()) << i << " " << call << ": " << response.status().message;
    }
  }
  return answered;
}

TEST(TwoHundredReplies, ArriveInBothFramings) {
  support::keep_cyclone_on_this_machine();
  support::StubServer server;
  ASSERT_TRUE(Client::connect(support::client_options()).ok()) << server.log();
  const Vandal vandal;

  // Clients that die while their request is on its way.
  const auto dying = support::cyclone_command(
      "cyclone_caller", {"1000", support::test_namespace() + "/unload_model"});
  std::vector<std::unique_ptr<support::Process>> doomed;
  for (int i = 0; i < 3; ++i) doomed.push_back(std::make_unique<support::Process>(dying));

  // 10 fresh processes on Cyclone, the first request of each included, and 5 fresh clients of ours.
  int cyclone_failures = 0;
  std::thread cyclone([&] {
    for (int i = 0; i < 10; ++i) {
      const auto command = support::cyclone_command(
          "cyclone_caller", {"10", support::test_namespace() + "/unload_model"});
      const std::string log = support::scratch_folder() + "/caller.log";
      if (support::run(command, log, seconds(20)) != 0) {
        ++cyclone_failures;
        ADD_FAILURE() << support::read_text(log);
      }
      if (i < 3) doomed[static_cast<std::size_t>(i)]->signal(SIGKILL);
    }
  });
  EXPECT_EQ(call_as_fast_dds(5, 20), 100) << server.log();
  cyclone.join();
  EXPECT_EQ(cyclone_failures, 0) << server.log();
  EXPECT_GT(vandal.sent(), 20);
  EXPECT_NE(server.log().find("refused a request"), std::string::npos);

  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok());
  EXPECT_LT(client->status()->memory_bytes, 500'000'000U);  // no length was believed
}

}  // namespace
}  // namespace bpa
