// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <fstream>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "idl/wire/time.hpp"
#include "tests/support/stub_server.hpp"

// What a ROS 2 node does without being asked: it follows /clock, and tells of its types.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using wire::rosgraph_msgs::Clock;
namespace rcl = wire::rcl_interfaces;
namespace types = wire::type_description_interfaces;

class RosNode : public testing::Test {
 protected:
  template <class Service>
  Result<typename Service::Response> call(const std::string& name,
                                          const typename Service::Request& request) {
    const auto client = wire::ServiceClient<Service>::create(*participant, name);
    return client->call(request, milliseconds(20000));
  }
  /// Publishes a time every 5 ms until `done`.
  template <class Done>
  bool tick_until(std::int64_t stamp_ns, const Done& done) {
    for (int i = 0; i < 4000; ++i) {
      if (done()) return true;
      EXPECT_TRUE(clock->publish(Clock{wire::builtin_interfaces::from_ns(stamp_ns)}).ok());
      std::this_thread::sleep_for(milliseconds(5));
    }
    return done();
  }

  Result<wire::Participant> participant = support::test_participant("tester");
  Result<wire::Publisher<Clock>> clock = wire::Publisher<Clock>::create(*participant, "/clock", {});
};

TEST_F(RosNode, StampsAndTimeoutsFollowTheClockTopic) {
  support::StubServer server({}, 0, {"--ros-args", "-p", "use_sim_time:=true"});
  const auto value = call<rcl::GetParameters>("server/get_parameters", {{"use_sim_time"}});
  ASSERT_TRUE(value.ok()) << value.status().message << server.log();
  EXPECT_TRUE(value->values.at(0).bool_value);

  std::atomic<std::int64_t> stamp_ns{0};
  const auto diagnostics = wire::Subscriber<wire::diagnostic_msgs::DiagnosticArray>::create(
      *participant, "diagnostics", {.qos = wire::qos::results()},
      [&](wire::diagnostic_msgs::DiagnosticArray&& array, const wire::SampleMeta&) {
        stamp_ns = to_ns(array.header.stamp);
      });
  constexpr std::int64_t kStart = 1'000'000'000'000;
  EXPECT_TRUE(tick_until(kStart, [&] { return stamp_ns == kStart; })) << stamp_ns;

  // Nothing publishes frames. As long as the simulation stands still, no second passes.
  wire::bpa_msgs::Detect_Request request;
  request.timeout_ms = 1000;
  auto answer = std::async(std::launch::async,
                           [&] { return call<wire::bpa_msgs::Detect>("detect", request); });
  const auto answered = [&] {
    return answer.wait_for(milliseconds(0)) == std::future_status::ready;
  };
  EXPECT_EQ(answer.wait_for(milliseconds(2500)), std::future_status::timeout);
  EXPECT_TRUE(tick_until(kStart + 1'000'000'000, answered));
  const auto response = answer.get();
  ASSERT_TRUE(response.ok()) << response.status().message;
  EXPECT_EQ(static_cast<StatusCode>(response->status.code), StatusCode::timeout);
  EXPECT_NE(response->status.message.find("no usable frame"), std::string::npos);
}

TEST_F(RosNode, TheClockMayBeChosenWhileItRuns) {
  support::StubServer server;
  std::atomic<std::int64_t> stamp_ns{0};
  const auto diagnostics = wire::Subscriber<wire::diagnostic_msgs::DiagnosticArray>::create(
      *participant, "diagnostics", {.qos = wire::qos::results()},
      [&](wire::diagnostic_msgs::DiagnosticArray&& array, const wire::SampleMeta&) {
        stamp_ns = to_ns(array.header.stamp);
      });
  constexpr std::int64_t kRecently = 1'600'000'000'000'000'000, kSimulated = 5'000'000'000;
  EXPECT_TRUE(tick_until(kSimulated, [&] { return stamp_ns > kRecently; })) << server.log();
  rcl::Parameter parameter;
  parameter.name = "use_sim_time";
  parameter.value.type = rcl::ParameterType::kBool;
  for (const bool simulated : {true, false}) {
    parameter.value.bool_value = simulated;
    const auto set = call<rcl::SetParameters>("server/set_parameters", {{parameter}});
    ASSERT_TRUE(set.ok()) << set.status().message;
    EXPECT_TRUE(set->results.at(0).successful) << set->results.at(0).reason;
    EXPECT_TRUE(tick_until(kSimulated, [&] { return (stamp_ns == kSimulated) == simulated; }));
  }
}

/// The JSON of which a type hash is the SHA-256 (REP 2011).
std::string json(const types::IndividualTypeDescription& type) {
  std::string fields;
  for (const types::Field& field : type.type_fields) {
    fields += concat(fields.empty() ? "" : ", ", "{\"name\": \"", field.name,
                     "\", \"type\": {\"type_id\": ", int{field.type.type_id},
                     ", \"capacity\": ", field.type.capacity,
                     ", \"string_capacity\": ", field.type.string_capacity,
                     ", \"nested_type_name\": \"", field.type.nested_type_name, "\"}}");
  }
  return concat("{\"type_name\": \"", type.type_name, "\", \"fields\": [", fields, "]}");
}
std::string json(const types::TypeDescription& description) {
  std::string referenced;
  for (const auto& type : description.referenced_type_descriptions) {
    referenced += (referenced.empty() ? "" : ", ") + json(type);
  }
  return "{\"type_description\": " + json(description.type_description) +
         ", \"referenced_type_descriptions\": [" + referenced + "]}";
}

TEST_F(RosNode, TellsOfItsTypesWhatTheirHashesSay) {
  support::StubServer server;
  const auto ask = [&](const std::string& type, const std::string& hash, bool sources = true) {
    const auto response =
        call<types::GetTypeDescription>("server/get_type_description", {type, hash, sources});
    EXPECT_TRUE(response.ok()) << type << response.status().message << server.log();
    return response.ok() ? *response : types::GetTypeDescription_Response();
  };
  const std::pair<const char*, const char*> ours[] = {
      {wire::bpa_msgs::SceneInterpretations::kType,
       wire::bpa_msgs::SceneInterpretations::kTypeHash},
      {wire::bpa_msgs::Detect_Request::kType, wire::bpa_msgs::Detect_Request::kTypeHash},
      {wire::sensor_msgs::CameraInfo::kType, wire::sensor_msgs::CameraInfo::kTypeHash},
      {rcl::ParameterEvent::kType, rcl::ParameterEvent::kTypeHash}};
  for (const auto& [type, hash] : ours) {
    const auto response = ask(type, hash);
    EXPECT_TRUE(response.successful) << response.failure_reason;
    EXPECT_EQ(response.type_description.type_description.type_name, type);
    ASSERT_EQ(response.type_sources.size(),
              1 + response.type_description.referenced_type_descriptions.size());
    EXPECT_EQ(response.type_sources[0].type_name, type);
    EXPECT_NE(response.type_sources[0].raw_file_contents.find("struct "), std::string::npos);
    const std::string path = support::scratch_folder() + "/type.json", sum = path + ".sha256";
    std::ofstream(path) << json(response.type_description);
    ASSERT_EQ(support::run({"/usr/bin/sha256sum", path}, sum), 0);
    EXPECT_EQ("RIHS01_" + support::read_text(sum).substr(0, 64), hash) << type;
  }
  const auto quaternion = ask("geometry_msgs/msg/Quaternion", "", false);
  EXPECT_EQ(quaternion.type_description.type_description.type_fields.at(3).default_value, "1.0");
  EXPECT_TRUE(quaternion.type_sources.empty());
  const auto own = ask(types::GetTypeDescription_Request::kType, "");
  EXPECT_EQ(own.type_description.type_description.type_fields.at(2).default_value, "True");
  const auto other = ask("sensor_msgs/msg/Image", "RIHS01_00");
  EXPECT_FALSE(other.successful);
  EXPECT_NE(other.failure_reason.find(wire::sensor_msgs::Image::kTypeHash), std::string::npos)
      << other.failure_reason;
  const auto unknown = ask("nav_msgs/msg/Path", "");
  EXPECT_FALSE(unknown.successful);
  EXPECT_NE(unknown.failure_reason.find("no type nav_msgs/msg/Path"), std::string::npos);
}

}  // namespace
}  // namespace bpa
