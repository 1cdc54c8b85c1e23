// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

// What `ros2 param` and `ros2 run ... --ros-args` do, with a server in another process.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
namespace rcl = wire::rcl_interfaces;
using rcl::ParameterType;

class ParametersOfAServer : public testing::Test {
 protected:
  void start(const std::vector<std::string>& words = {}) {
    server = std::make_unique<support::StubServer>(std::vector<std::string>(), 0, words);
    auto seat = support::test_participant("tools");
    ASSERT_TRUE(seat.ok()) << seat.status().message;
    participant.emplace(std::move(seat).value());
  }
  template <class Service>
  typename Service::Response call(const char* name, const typename Service::Request& request) {
    const auto client = wire::ServiceClient<Service>::create(*participant, node + "/" + name,
                                                             wire::qos::parameters());
    auto response = client->call(request, seconds(10));
    EXPECT_TRUE(response.ok()) << name << ": " << response.status().message << server->log();
    return response.ok() ? *std::move(response) : typename Service::Response();
  }
  static rcl::Parameter integer(const std::string& name, std::int64_t value) {
    rcl::Parameter parameter;
    parameter.name = name;
    parameter.value.type = ParameterType::kInteger;
    parameter.value.integer_value = value;
    return parameter;
  }
  std::int64_t get(const std::string& name) {
    return call<rcl::GetParameters>("get_parameters", {{name}}).values.at(0).integer_value;
  }

  const std::string node_namespace = support::test_namespace();
  std::string node = node_namespace + "/server";
  std::unique_ptr<support::StubServer> server;
  std::optional<wire::Participant> participant;
};

// The fields of a tree of settings, by their whole names.
void add_fields(const YAML::Node& node, const std::string& name,
                std::map<std::string, YAML::Node>& fields) {
  if (!node.IsMap()) {
    fields[name] = node;
    return;
  }
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    add_fields(entry.second, name.empty() ? key : name + "." + key, fields);
  }
}

void expect_same(const rcl::ParameterValue& value, const YAML::Node& field,
                 const std::string& name) {
  switch (value.type) {
    case ParameterType::kBool:
      EXPECT_EQ(value.bool_value, field.as<bool>()) << name;
      break;
    case ParameterType::kInteger:
      EXPECT_EQ(value.integer_value, field.as<std::int64_t>()) << name;
      break;
    case ParameterType::kDouble:
      EXPECT_EQ(value.double_value, field.as<double>()) << name;
      break;
    case ParameterType::kString:
      EXPECT_EQ(value.string_value, field.as<std::string>()) << name;
      break;
    default:
      ASSERT_EQ(value.type, ParameterType::kStringArray) << name;
      EXPECT_EQ(value.string_array_value, field.as<std::vector<std::string>>()) << name;
  }
}

// config/detector.yaml with every key in force.
YAML::Node detector_yaml() {
  std::string text = support::read_text(BPA_SOURCE_DIR "/config/detector.yaml");
  for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + 1)) {
    if (text[at + 1] != ' ') text.erase(at, 1);
  }
  return YAML::Load(text);
}

TEST_F(ParametersOfAServer, AgreeWithPrintConfigAndDetectorYaml) {
  start({"--set", "network.range=localhost"});
  std::vector<std::string> command{BPA_BINARY_DIR "/bin/bpa-server", "--print-config"};
  for (const std::string& word : server->words()) command.push_back(word);
  const std::string path = support::scratch_folder() + "/printed.yaml";
  ASSERT_EQ(support::run(command, path), 0) << support::read_text(path);

  std::map<std::string, YAML::Node> printed, documented;
  add_fields(YAML::LoadFile(path), "", printed);
  printed["use_sim_time"] = printed.at("node.use_sim_time");
  printed.erase("node.use_sim_time");
  add_fields(detector_yaml(), "detector", documented);

  const auto names = call<rcl::ListParameters>("list_parameters", {{}, 0}).result.names;
  const auto values = call<rcl::GetParameters>("get_parameters", {names}).values;
  ASSERT_EQ(values.size(), names.size());
  EXPECT_EQ(names.size(), printed.size());
  EXPECT_GT(documented.size(), 50U);
  for (std::size_t i = 0; i < names.size(); ++i) {
    ASSERT_EQ(printed.count(names[i]), 1U) << names[i];
    expect_same(values[i], printed[names[i]], names[i]);
    if (names[i].rfind("detector.", 0) != 0) continue;
    ASSERT_EQ(documented.count(names[i]), 1U) << names[i];
    expect_same(values[i], documented[names[i]], names[i]);
    documented.erase(names[i]);
  }
  EXPECT_TRUE(documented.empty()) << documented.begin()->first << " is no parameter";
}

TEST_F(ParametersOfAServer, ListGetDescribeSetAndEvents) {
  start();
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<rcl::ParameterEvent> events;
  wire::SubscriberOptions subscription;
  subscription.qos = wire::qos::parameters();
  const auto subscriber = wire::Subscriber<rcl::ParameterEvent>::create(
      *participant, "parameter_events", subscription,
      [&](rcl::ParameterEvent&& event, const wire::SampleMeta&) {
        const std::lock_guard<std::mutex> lock(mutex);
        events.push_back(std::move(event));
        changed.notify_all();
      });
  ASSERT_TRUE(subscriber.ok());

  const auto listed = call<rcl::ListParameters>("list_parameters", {{"detection"}, 0}).result;
  EXPECT_NE(std::find(listed.names.begin(), listed.names.end(), "detection.top_k"),
            listed.names.end());
  EXPECT_EQ(listed.prefixes, std::vector<std::string>{"detection"});
  const auto types = call<rcl::GetParameterTypes>("get_parameter_types",
                                                  {{"detection.top_k", "log.level", "nothing"}});
  EXPECT_EQ(types.types,
            (std::vector<std::uint8_t>{ParameterType::kInteger, ParameterType::kString, 0}));
  const auto described =
      call<rcl::DescribeParameters>("describe_parameters", {{"detection.top_k"}}).descriptors;
  EXPECT_EQ(described.at(0).integer_range.at(0).to_value, 100);
  EXPECT_EQ(get("detection.top_k"), 20);

  // One by one: the good ones pass, the others say why not.
  ASSERT_TRUE(subscriber->wait_for_matched(seconds(10)));
  const auto results = call<rcl::SetParameters>(
      "set_parameters",
      {{integer("detection.top_k", 5), integer("detection.top_k", 0), integer("network.domain", 3),
        integer("nothing", 1), integer("detector.features.max_keypoints", 321)}});
  ASSERT_EQ(results.results.size(), 5U);
  EXPECT_TRUE(results.results[0].successful);
  EXPECT_NE(results.results[1].reason.find("between 1 and 100"), std::string::npos);
  EXPECT_NE(results.results[2].reason.find("read-only"), std::string::npos);
  EXPECT_NE(results.results[3].reason.find("no parameter"), std::string::npos);
  EXPECT_TRUE(results.results[4].successful) << results.results[4].reason;
  EXPECT_EQ(get("detection.top_k"), 5);
  EXPECT_NE(server->log().find("max_keypoints is 321"), std::string::npos) << server->log();

  // All or none.
  const auto none = call<rcl::SetParametersAtomically>(
      "set_parameters_atomically",
      {{integer("detection.top_k", 6), integer("queue.requests", -1)}});
  EXPECT_FALSE(none.result.successful);
  EXPECT_EQ(get("detection.top_k"), 5);

  std::unique_lock<std::mutex> lock(mutex);
  const auto told = [&](const std::string& name, std::int64_t value) {
    for (const auto& event : events) {
      for (const auto& one : event.changed_parameters) {
        if (event.node == node && one.name == name && one.value.integer_value == value) return true;
      }
    }
    return false;
  };
  EXPECT_TRUE(changed.wait_for(lock, seconds(10), [&] {
    return told("detection.top_k", 5) && told("detector.features.max_keypoints", 321);
  }));
  EXPECT_FALSE(told("detection.top_k", 6));
}

TEST_F(ParametersOfAServer, RequestsAboutTooManyHaveAnEmptyAnswer) {
  start();
  const std::vector<std::string> many(100'000);
  EXPECT_TRUE(call<rcl::GetParameters>("get_parameters", {many}).values.empty());
  EXPECT_TRUE(call<rcl::GetParameterTypes>("get_parameter_types", {many}).types.empty());
  EXPECT_TRUE(call<rcl::DescribeParameters>("describe_parameters", {many}).descriptors.empty());
  EXPECT_TRUE(call<rcl::ListParameters>("list_parameters", {many, 0}).result.names.empty());
  EXPECT_NE(server->log().find("100000 parameters has an empty answer"), std::string::npos);
  const std::vector<rcl::Parameter> settings(2000, integer("detection.top_k", 5));
  const auto results = call<rcl::SetParameters>("set_parameters", {settings}).results;
  ASSERT_EQ(results.size(), 1U);
  EXPECT_NE(results[0].reason.find("at most 1000"), std::string::npos) << results[0].reason;
  EXPECT_FALSE(call<rcl::SetParametersAtomically>("set_parameters_atomically", {settings})
                   .result.successful);
  EXPECT_EQ(get("detection.top_k"), 20);

  // What is too large is not even decoded; meanwhile and after it all others are served.
  const auto flood = wire::ServiceClient<rcl::GetParameters>::create(
      *participant, node + "/get_parameters", wire::qos::parameters());
  const std::vector<std::string> more(2'000'000);
  EXPECT_EQ(flood->call({more}, milliseconds(1500)).status().code, StatusCode::timeout);
  EXPECT_EQ(get("detection.top_k"), 20);
  EXPECT_NE(server->log().find("at most 1048576 are read"), std::string::npos) << server->log();
}

TEST_F(ParametersOfAServer, PausingStopsTheStreamAndNotTheRequests) {
  start();
  std::atomic<int> results{0};
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  ASSERT_TRUE(client->subscribe([&](const DetectionSet&) { ++results; }).ok());
  const auto depth = support::wall_depth_mm();
  FrameView frame;
  frame.width = static_cast<int>(support::kWidth);
  frame.height = static_cast<int>(support::kHeight);
  frame.depth_mm = depth.data();
  frame.fx = frame.fy = 60;
  rcl::Parameter continuous;
  continuous.name = "detection.continuous";
  continuous.value.type = ParameterType::kBool;
  ASSERT_TRUE(call<rcl::SetParameters>("set_parameters", {{continuous}}).results.at(0).successful);
  EXPECT_EQ(client->status()->state, "paused");
  for (int i = 1; i <= 3; ++i) {
    frame.stamp_ns = i;
    ASSERT_TRUE(client->publish_frame(frame).ok());
  }
  const auto found = client->detect();  // the frame that came last waits for such a request
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_EQ(results, 0);
  continuous.value.bool_value = true;
  ASSERT_TRUE(call<rcl::SetParameters>("set_parameters", {{continuous}}).results.at(0).successful);
  for (int i = 0; i < 40 && results == 0; ++i) {
    ASSERT_TRUE(client->publish_frame(frame).ok());
    std::this_thread::sleep_for(milliseconds(50));
  }
  EXPECT_GT(results, 0);
  EXPECT_EQ(client->status()->state, "running");
}

TEST_F(ParametersOfAServer, RosArgumentsNameTheNodeAndItsTopics) {
  node = node_namespace + "/eyes/left";
  start({"--ros-args", "-r", "__node:=left", "-r", "__ns:=" + node_namespace + "/eyes", "-r",
         "get_status:=" + node_namespace + "/how_are_you", "-p", "detection.top_k:=7",
         "--log-level", "error"});
  EXPECT_EQ(get("detection.top_k"), 7);
  const auto renamed = wire::ServiceClient<wire::bpa_msgs::GetStatus>::create(
      *participant, node_namespace + "/how_are_you");
  const auto status = renamed->call({}, seconds(10));
  ASSERT_TRUE(status.ok()) << status.status().message;
  EXPECT_TRUE(status->success);
  EXPECT_EQ(server->log(), "");  // only errors are said
}

}  // namespace
}  // namespace bpa
