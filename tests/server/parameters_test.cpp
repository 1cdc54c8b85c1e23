// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/parameters.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "server/settings.hpp"

namespace bpa::server {
namespace {

using wire::rcl_interfaces::Parameter;
using wire::rcl_interfaces::ParameterType;
using wire::rcl_interfaces::ParameterValue;

Parameter integer(const std::string& name, std::int64_t value) {
  Parameter parameter;
  parameter.name = name;
  parameter.value.type = ParameterType::kInteger;
  parameter.value.integer_value = value;
  return parameter;
}

Parameter text(const std::string& name, const std::string& value) {
  Parameter parameter;
  parameter.name = name;
  parameter.value.type = ParameterType::kString;
  parameter.value.string_value = value;
  return parameter;
}

TEST(Parameters, EverySettingIsOneWithItsTypeAndValue) {
  ServerOptions options;
  options.network.peers = {"a", "b"};
  const auto all = all_parameters(options);
  std::set<std::string> names;
  for (const Parameter& one : all) {
    names.insert(one.name);
    EXPECT_NE(one.value.type, ParameterType::kNotSet) << one.name;
    EXPECT_EQ(describe_parameter(one.name).type, one.value.type) << one.name;
    EXPECT_FALSE(describe_parameter(one.name).description.empty()) << one.name;
  }
  EXPECT_EQ(names.size(), all.size());
  // Every line "  key: value" of the printed settings is one of them.
  const std::string yaml = to_yaml(options, true);
  const auto lines = static_cast<std::size_t>(std::count(yaml.begin(), yaml.end(), '\n'));
  EXPECT_GT(names.size(), 40U);
  EXPECT_LT(names.size(), lines);
  EXPECT_EQ(parameter(options, "network.peers").string_array_value, options.network.peers);
  EXPECT_EQ(parameter(options, "detection.top_k").integer_value, 20);
  EXPECT_EQ(parameter(options, "detector.surface.max_range_m").type, ParameterType::kDouble);
  EXPECT_EQ(parameter(options, "nothing").type, ParameterType::kNotSet);
  EXPECT_EQ(parameter(options, "use_sim_time").type, ParameterType::kBool);  // as of every node
  EXPECT_EQ(parameter(options, "node.use_sim_time").type, ParameterType::kNotSet);
}

TEST(Parameters, DescriptionsCarryRangesAndWhatIsReadOnly) {
  const auto top_k = describe_parameter("detection.top_k");
  EXPECT_FALSE(top_k.read_only);
  ASSERT_EQ(top_k.integer_range.size(), 1U);
  EXPECT_EQ(top_k.integer_range[0].from_value, 1);
  EXPECT_EQ(top_k.integer_range[0].to_value, 100);
  const auto tolerance = describe_parameter("input.sync_tolerance_ms");
  ASSERT_EQ(tolerance.floating_point_range.size(), 1U);
  EXPECT_EQ(tolerance.floating_point_range[0].to_value, 1000);
  EXPECT_FALSE(tolerance.read_only);
  EXPECT_TRUE(describe_parameter("input.depth").read_only);
  EXPECT_TRUE(describe_parameter("network.domain").read_only);
  EXPECT_FALSE(describe_parameter("detector.scene.min_probability").read_only);
  EXPECT_EQ(describe_parameter("nothing").type, ParameterType::kNotSet);
}

TEST(Parameters, SettingChecksNameTypeAndReadOnly) {
  ServerOptions options;
  EXPECT_TRUE(set_parameter(integer("detection.top_k", 3), options).ok());
  EXPECT_EQ(options.detection.top_k, 3);
  EXPECT_TRUE(set_parameter(integer("detection.budget_ms", 250), options).ok());  // widened
  EXPECT_EQ(options.detection.budget_ms, 250);
  EXPECT_EQ(set_parameter(integer("detection.top", 3), options).code, StatusCode::not_found);
  EXPECT_EQ(set_parameter(text("input.depth", "/x"), options).code, StatusCode::unsupported);
  const Status wrong = set_parameter(text("detection.top_k", "3"), options);
  EXPECT_EQ(wrong.code, StatusCode::invalid_argument);
  EXPECT_NE(wrong.message.find("type integer"), std::string::npos) << wrong.message;
  Parameter gone = integer("detection.top_k", 3);
  gone.value.type = ParameterType::kNotSet;  // "delete it"
  EXPECT_FALSE(set_parameter(gone, options).ok());
  gone.value.type = 200;
  EXPECT_FALSE(set_parameter(gone, options).ok());
  EXPECT_FALSE(set_parameter(integer("detection.seed", -1), options).ok());
  EXPECT_FALSE(set_parameter(integer("detection.top_k", 1LL << 40), options).ok());
}

TEST(Parameters, ListsByPrefixAndDepthAsRclcppDoes) {
  const auto all = list_parameters({}, 0);
  EXPECT_EQ(all.names.size(), all_parameters(ServerOptions()).size());
  EXPECT_EQ(list_parameters({}, 1).names, std::vector<std::string>{"use_sim_time"});
  EXPECT_EQ(list_parameters({}, 4).names, all.names);
  const auto two = list_parameters({}, 2).names;
  EXPECT_LT(two.size(), all.names.size());
  for (const std::string& name : two) EXPECT_LE(std::count(name.begin(), name.end(), '.'), 1);
  const auto queue = list_parameters({"queue"}, 1);
  EXPECT_EQ(queue.names, (std::vector<std::string>{"queue.frames", "queue.requests"}));
  EXPECT_EQ(queue.prefixes, std::vector<std::string>{"queue"});
  EXPECT_EQ(list_parameters({"queue.frames"}, 0).names, std::vector<std::string>{"queue.frames"});
  EXPECT_TRUE(list_parameters({"que"}, 0).names.empty());
}

TEST(Settings, ChangesOnlyWhatIsLegalAndCanBeApplied) {
  Settings settings{ServerOptions()};
  int applied = 0;
  settings.on_change([&](const ServerOptions&, const ServerOptions& after) -> Status {
    if (after.detection.seed == 13) return Status(StatusCode::internal, "not that one");
    ++applied;
    return {};
  });
  const auto set = [&](auto edit) {
    return settings.change([&](ServerOptions& options) {
      edit(options);
      return Status();
    });
  };
  EXPECT_TRUE(set([](ServerOptions& o) { o.detection.top_k = 7; }).ok());
  const Status out_of_range = set([](ServerOptions& o) { o.detection.top_k = 0; });
  EXPECT_NE(out_of_range.message.find("detection.top_k is 0; it must be between 1 and 100"),
            std::string::npos);
  EXPECT_FALSE(set([](ServerOptions& o) { o.detection.seed = 13; }).ok());
  EXPECT_EQ(applied, 1);
  EXPECT_EQ(settings.get()->detection.top_k, 7);
  EXPECT_EQ(settings.get()->detection.seed, 0U);
}

TEST(Parameters, ChangedOnesAreThoseThatDiffer) {
  ServerOptions before, after;
  EXPECT_TRUE(changed_parameters(before, after).empty());
  after.detection.continuous = false;
  after.detector.features.max_keypoints += 1;
  const auto changed = changed_parameters(before, after);
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].name, "detection.continuous");
  EXPECT_EQ(changed[1].name, "detector.features.max_keypoints");
}

}  // namespace
}  // namespace bpa::server
