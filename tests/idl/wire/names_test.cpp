// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/names.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "idl/wire/participant.hpp"

namespace bpa::wire {
namespace {

TEST(Names, InDds) {
  EXPECT_EQ(dds_topic_name("/camera/depth/image_raw"), "rt/camera/depth/image_raw");
  EXPECT_EQ(dds_request_topic_name("/detector/reset"), "rq/detector/resetRequest");
  EXPECT_EQ(dds_reply_topic_name("/detector/reset"), "rr/detector/resetReply");
  EXPECT_EQ(dds_type_name("sensor_msgs/msg/Image"), "sensor_msgs::msg::dds_::Image_");
  EXPECT_EQ(dds_type_name("bpa_msgs/srv/Detect_Response"), "bpa_msgs::srv::dds_::Detect_Response_");
}

TEST(Names, Rules) {
  for (const char* good : {"/a", "/a/b_1", "/_hidden/x", "/A9"}) {
    EXPECT_TRUE(validate_full_name(good).ok()) << good;
  }
  for (const char* bad : {"", "a", "/", "/a/", "/a//b", "/9a", "/a/9", "/a b", "/a-b", "/a__b",
                          "/\xc3\xa4", "/~/a"}) {
    const Status status = validate_full_name(bad);
    EXPECT_EQ(status.code, StatusCode::invalid_argument) << bad;
    EXPECT_NE(status.message.find(std::string("'") + bad + "'"), std::string::npos);
  }
  EXPECT_TRUE(validate_full_name("/" + std::string(246, 'a')).ok());
  EXPECT_FALSE(validate_full_name("/" + std::string(247, 'a')).ok());
}

std::string resolved(const std::string& name, const NodeName& node,
                     const std::vector<Remap>& remaps = {}) {
  const auto result = resolve_name(name, node, remaps);
  return result.ok() ? result.value() : result.status().message;
}

TEST(Names, AsTheNodeSeesThem) {
  const NodeName root{"/", "bpa_server"};
  const NodeName deep{"/robot/left", "bpa"};
  EXPECT_EQ(root.full(), "/bpa_server");
  EXPECT_EQ(deep.full(), "/robot/left/bpa");
  EXPECT_EQ(resolved("frames", root), "/frames");
  EXPECT_EQ(resolved("frames", deep), "/robot/left/frames");
  EXPECT_EQ(resolved("~/get_parameters", root), "/bpa_server/get_parameters");
  EXPECT_EQ(resolved("~/x", deep), "/robot/left/bpa/x");
  EXPECT_EQ(resolved("/bpa/detect", deep), "/bpa/detect");
}

TEST(Names, Remaps) {
  const NodeName node{"/robot", "bpa"};
  const std::vector<Remap> remaps = {
      {"color", "/camera/color/image_raw"}, {"/robot/color", "/z"}, {"~/detect", "find"}};
  EXPECT_EQ(resolved("color", node, remaps), "/camera/color/image_raw");
  EXPECT_EQ(resolved("/robot/bpa/detect", node, remaps), "/robot/find");
  EXPECT_EQ(resolved("depth", node, remaps), "/robot/depth");
  const auto remap = parse_remap("a:=/b/c");
  ASSERT_TRUE(remap.ok());
  EXPECT_EQ(remap.value().from, "a");
  EXPECT_EQ(remap.value().to, "/b/c");
  for (const char* bad : {"", "a", "a=b", ":=b", "a:="}) EXPECT_FALSE(parse_remap(bad).ok()) << bad;
}

class Environment : public testing::Test {
 protected:
  void SetUp() override { clear(); }
  void TearDown() override { clear(); }
  static void clear() {
    for (const char* name : {"ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                             "ROS_STATIC_PEERS"}) {
      unsetenv(name);
    }
  }
};

TEST_F(Environment, Defaults) {
  const auto discovery = discovery_from_environment();
  ASSERT_TRUE(discovery.ok());
  EXPECT_EQ(discovery.value().domain_id, 0);
  EXPECT_EQ(discovery.value().range, DiscoveryRange::subnet);
  EXPECT_TRUE(discovery.value().static_peers.empty());
}

TEST_F(Environment, IsReadAsRosReadsIt) {
  setenv("ROS_DOMAIN_ID", "42", 1);
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost", 1);
  setenv("ROS_STATIC_PEERS", "10.0.0.1;;robot;", 1);
  const auto discovery = discovery_from_environment();
  ASSERT_TRUE(discovery.ok());
  EXPECT_EQ(discovery.value().domain_id, 42);
  EXPECT_EQ(discovery.value().range, DiscoveryRange::localhost);
  EXPECT_EQ(discovery.value().static_peers, (std::vector<std::string>{"10.0.0.1", "robot"}));
}

TEST_F(Environment, LocalhostOnlyOverridesTheRest) {
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  setenv("ROS_STATIC_PEERS", "10.0.0.1", 1);
  const auto discovery = discovery_from_environment();
  ASSERT_TRUE(discovery.ok());
  EXPECT_EQ(discovery.value().range, DiscoveryRange::localhost);
  EXPECT_TRUE(discovery.value().static_peers.empty());
}

TEST_F(Environment, WrongValuesAreNamed) {
  for (const char* value : {"-1", "233", "x", "1x", "99999999999"}) {
    setenv("ROS_DOMAIN_ID", value, 1);
    const auto discovery = discovery_from_environment();
    ASSERT_FALSE(discovery.ok()) << value;
    EXPECT_NE(discovery.status().message.find("ROS_DOMAIN_ID"), std::string::npos);
  }
  clear();
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "EVERYWHERE", 1);
  EXPECT_FALSE(discovery_from_environment().ok());
  clear();
  setenv("ROS_LOCALHOST_ONLY", "yes", 1);
  EXPECT_FALSE(discovery_from_environment().ok());
}

}  // namespace
}  // namespace bpa::wire
