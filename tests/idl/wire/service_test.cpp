// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/service.hpp"

#include <chrono>
#include <future>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/private/service_framing.hpp"
#include "tests/idl/wire/domain.hpp"

namespace bpa::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Unload = bpa_msgs::UnloadModel;
using UnloadServer = ServiceServer<Unload>;
using UnloadClient = ServiceClient<Unload>;

void answer(Unload::Request&& request, const ReplyToken<Unload>& token) {
  Unload::Response response;
  response.success = true;
  response.status.message = "hello " + request.name;
  EXPECT_TRUE(token.reply(response).ok());
}

TEST(Service, AnswersAtOnce) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  auto server = UnloadServer::create(*one, "unload_model", answer);
  auto client = UnloadClient::create(*two, "unload_model");
  ASSERT_TRUE(server.ok() && client.ok());
  for (int i = 0; i < 20; ++i) {
    Unload::Request request;
    request.name = std::to_string(i);
    auto response = client->call(request, seconds(5));
    ASSERT_TRUE(response.ok()) << response.status().message;
    EXPECT_EQ(response->status.message, "hello " + request.name);
  }
  EXPECT_EQ(server->statistics().received, 20U);
}

TEST(Service, AnswersLaterFromAnotherThreadAndOutOfOrder) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  std::mutex mutex;
  std::vector<std::pair<Unload::Request, ReplyToken<Unload>>> requests;
  auto server = UnloadServer::create(*one, "later", [&](Unload::Request&& request, auto token) {
    const std::lock_guard<std::mutex> lock(mutex);
    requests.emplace_back(std::move(request), std::move(token));
  });
  auto client = UnloadClient::create(*two, "later");
  ASSERT_TRUE(server.ok() && client.ok());
  constexpr std::size_t kCalls = 8;
  std::vector<std::future<Result<Unload::Response>>> calls;
  for (std::size_t i = 0; i < kCalls; ++i) {
    calls.push_back(std::async(std::launch::async, [&client, i] {
      Unload::Request request;
      request.name = std::to_string(i);
      return client->call(request, seconds(10));
    }));
  }
  for (int i = 0; i < 500; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    const std::lock_guard<std::mutex> lock(mutex);
    if (requests.size() == kCalls) break;
  }
  ASSERT_EQ(requests.size(), kCalls);
  for (auto request = requests.rbegin(); request != requests.rend(); ++request) {
    answer(std::move(request->first), request->second);
  }
  for (std::size_t i = 0; i < kCalls; ++i) {
    const auto response = calls[i].get();
    ASSERT_TRUE(response.ok()) << response.status().message;
    EXPECT_EQ(response.value().status.message, "hello " + std::to_string(i));
  }
  EXPECT_EQ(requests[0].second.reply({}).code, StatusCode::invalid_argument);
}

TEST(Service, SaysWhyThereIsNoAnswer) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  auto client = UnloadClient::create(*two, "silent");
  ASSERT_TRUE(client.ok());
  EXPECT_EQ(client->call({}, milliseconds(50)).status().code, StatusCode::unavailable);
  std::optional<ReplyToken<Unload>> kept;
  {
    auto server = UnloadServer::create(
        *one, "silent", [&kept](Unload::Request&&, ReplyToken<Unload> token) { kept = token; });
    ASSERT_TRUE(server.ok());
    ASSERT_TRUE(client->wait_for_service(seconds(5)));
    EXPECT_EQ(client->call({}, milliseconds(100)).status().code, StatusCode::timeout);
  }
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->reply({}).code, StatusCode::unavailable);
}

TEST(Service, ACallThatWaitsLearnsThatItsServerHasGone) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  std::promise<void> asked;
  std::optional<UnloadServer> server;
  auto made = UnloadServer::create(*one, "goes", [&asked](auto&&, auto) { asked.set_value(); });
  ASSERT_TRUE(made.ok());
  server.emplace(std::move(made).value());
  auto client = UnloadClient::create(*two, "goes");
  ASSERT_TRUE(client.ok());
  auto call = std::async(std::launch::async, [&] { return client->call({}, seconds(60)); });
  ASSERT_EQ(asked.get_future().wait_for(seconds(10)), std::future_status::ready);
  made = Status(StatusCode::not_found, "gone");
  server.reset();
  const Status status = call.get().status();
  EXPECT_EQ(status.code, StatusCode::unavailable) << status.message;
}

TEST(Service, TwoServersOfOneNameAreSaid) {
  std::mutex mutex;
  std::vector<std::string> said;
  const auto hook = [&](LogLevel, std::string_view text) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (text.find("another process offers") != text.npos) said.emplace_back(text);
  };
  auto one = test_participant("one", hook);
  auto two = test_participant("two", hook);
  auto three = test_participant("three");
  ASSERT_TRUE(one.ok() && two.ok() && three.ok());
  auto client = UnloadClient::create(*three, "twice");  // a client is no rival
  const auto first = UnloadServer::create(*one, "twice", answer);
  ASSERT_TRUE(client.ok() && first.ok());
  ASSERT_TRUE(client->wait_for_service(seconds(10)));
  {
    const std::lock_guard<std::mutex> lock(mutex);
    EXPECT_TRUE(said.empty()) << said.front();
  }
  const auto second = UnloadServer::create(*two, "twice", answer);
  ASSERT_TRUE(second.ok());
  for (int i = 0; i < 500; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
    const std::lock_guard<std::mutex> lock(mutex);
    if (said.size() >= 2) break;
  }
  const std::lock_guard<std::mutex> lock(mutex);
  ASSERT_EQ(said.size(), 2U);  // each of the two
  EXPECT_NE(said[0].find("rq/twiceRequest"), std::string::npos) << said[0];
}

TEST(Service, ClientGoesOnWithTheNextServer) {
  auto two = test_participant("client");
  ASSERT_TRUE(two.ok());
  auto client = UnloadClient::create(*two, "restarts");
  ASSERT_TRUE(client.ok());
  for (int life = 0; life < 3; ++life) {
    auto one = test_participant("server");
    ASSERT_TRUE(one.ok());
    auto server = UnloadServer::create(*one, "restarts", answer);
    ASSERT_TRUE(server.ok());
    Unload::Request request;
    request.name = "x";
    bool answered = false;  // a call may still go to the server that has just ended
    for (int i = 0; i < 10 && !answered; ++i) answered = client->call(request, seconds(1)).ok();
    EXPECT_TRUE(answered);
  }
}

TEST(Service, MalformedRequestsAreCountedAndTheNextIsServed) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  auto server = UnloadServer::create(*one, "strict", answer);
  auto client = UnloadClient::create(*two, "strict");
  ASSERT_TRUE(server.ok() && client.ok());
  auto writer = detail::make_writer(
      *two, detail::endpoint_spec<Unload::Request>("rq/strictRequest", qos::services()));
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(client->wait_for_service(seconds(5)));
  ASSERT_TRUE(writer.value()->matches().wait_for(1, seconds(5)));
  const SampleId client_id{{1, 2, 3}, 0};
  const std::vector<std::uint8_t> long_name = {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 'a', 0};
  const std::vector<std::uint8_t> no_header = {0, 1, 0, 0, 2, 0, 0, 0, 'a', 0};
  ASSERT_TRUE(writer.value()->write(detail::bytes_ref(long_name), &client_id, nullptr).ok());
  ASSERT_TRUE(writer.value()->write(detail::bytes_ref(no_header), nullptr, nullptr).ok());
  // What two writers send reaches a reader in no certain order.
  for (int i = 0; i < 500 && server->statistics().malformed < 2; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_EQ(server->statistics().malformed, 2U);
  Unload::Request request;
  request.name = "x";
  EXPECT_TRUE(client->call(request, seconds(5)).ok());
  EXPECT_EQ(server->statistics().malformed, 2U);
  EXPECT_EQ(server->statistics().received, 1U);
}

TEST(Service, LargeRequestsAreRefusedBeforeTheyAreDecoded) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  auto server = UnloadServer::create(*one, "small", answer, qos::services(), 100);
  auto client = UnloadClient::create(*two, "small");
  ASSERT_TRUE(server.ok() && client.ok());
  Unload::Request request;
  request.name = std::string(100, 'x');
  EXPECT_EQ(client->call(request, milliseconds(1000)).status().code, StatusCode::timeout);
  EXPECT_EQ(server->statistics().malformed, 1U);
  request.name = std::string(80, 'x');
  EXPECT_TRUE(client->call(request, seconds(5)).ok());
}

TEST(Service, AHandlerThatThrowsCostsItsRequestAlone) {
  auto one = test_participant("server");
  auto two = test_participant("client");
  ASSERT_TRUE(one.ok() && two.ok());
  auto server = UnloadServer::create(*one, "throws", [](Unload::Request&& request, auto token) {
    if (request.name == "bad") throw std::runtime_error("out of luck");
    answer(std::move(request), token);
  });
  auto client = UnloadClient::create(*two, "throws");
  ASSERT_TRUE(server.ok() && client.ok());
  Unload::Request request;
  request.name = "bad";
  EXPECT_EQ(client->call(request, milliseconds(2000)).status().code, StatusCode::timeout);
  request.name = "good";
  EXPECT_TRUE(client->call(request, seconds(5)).ok());
}

// A request as rmw_cyclonedds frames it, in both byte orders.
TEST(ServiceFraming, CycloneHeaderIsEchoedInTheRepliesOrder) {
  SampleMeta meta;
  meta.id.writer = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 0x10, 3};
  std::vector<std::uint8_t> request = {0, 1, 0, 0};
  for (int i = 0; i < 16; ++i) request.push_back(static_cast<std::uint8_t>(i));
  request.insert(request.end(), {3, 0, 0, 0, 'a', 'b', 0});
  detail::ReplyAddress address;
  std::size_t offset = 0;
  bool swap = true;
  ASSERT_TRUE(detail::read_request_frame(request, meta, &address, &offset, &swap).ok());
  EXPECT_FALSE(swap);
  EXPECT_EQ(offset, 20U);
  EXPECT_EQ(address.framing, detail::Framing::cyclone);
  EXPECT_EQ(address.reader, (Guid{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 0, 0, 0}));
  Unload::Response response;
  response.success = true;
  const auto reply = detail::frame_reply(address, detail::message_ref(response));
  const auto plain = encode(response);
  ASSERT_EQ(reply.size(), plain.size() + 16);
  EXPECT_TRUE(std::equal(reply.begin() + 4, reply.begin() + 20, request.begin() + 4));
  EXPECT_TRUE(std::equal(reply.begin() + 20, reply.end(), plain.begin() + 4));

  request[1] = 0;  // big-endian
  ASSERT_TRUE(detail::read_request_frame(request, meta, &address, &offset, &swap).ok());
  EXPECT_TRUE(swap);
  EXPECT_EQ(address.header[0], 7);
  EXPECT_EQ(address.header[8], 15);
}

TEST(ServiceFraming, ShortRequestsAreRefused) {
  detail::ReplyAddress address;
  std::size_t offset = 0;
  bool swap = false;
  for (std::size_t size = 0; size < 20; ++size) {
    std::vector<std::uint8_t> bytes(size, 0);
    if (size > 1) bytes[1] = 1;
    EXPECT_FALSE(detail::read_request_frame(bytes, {}, &address, &offset, &swap).ok());
  }
}

TEST(ServiceFraming, FastDdsRepliesGoToTheReaderThatTheRequestNames) {
  SampleMeta meta;
  meta.id = {{9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 0, 0, 1, 3}, 42};
  meta.related.writer = {9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 0, 0, 2, 4};
  detail::ReplyAddress address;
  std::size_t offset = 0;
  bool swap = false;
  const std::vector<std::uint8_t> request = {0, 1, 0, 0, 1, 0, 0, 0, 0};
  ASSERT_TRUE(detail::read_request_frame(request, meta, &address, &offset, &swap).ok());
  EXPECT_EQ(address.framing, detail::Framing::fastdds);
  EXPECT_EQ(offset, 4U);
  EXPECT_EQ(address.reader, meta.related.writer);
  EXPECT_EQ(address.related.writer, meta.related.writer);
  EXPECT_EQ(address.related.sequence, 42);
}

}  // namespace
}  // namespace bpa::wire
