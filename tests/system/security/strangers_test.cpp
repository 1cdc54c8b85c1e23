// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/system/security/secured.hpp"
#include "tests/system/security/spy.hpp"

// Who may talk to a server with a keystore, and who may not. Strangers do the same to a server
// without one, where all of it succeeds.

namespace bpa::test {
namespace {

namespace fs = std::filesystem;
namespace msgs = wire::bpa_msgs;
namespace rcl = wire::rcl_interfaces;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// What a participant gets done.
struct Reach {
  bool matched = false;   ///< An endpoint of the server's with one of ours.
  bool read = false;      ///< A message of the server's, latched ones included.
  bool answered = false;  ///< A call.
};

/// What one who knows all names and types tries: reads results and latched messages, sends frames,
/// asks for models and sets a parameter. `meanwhile` makes the server publish.
Reach try_all(const std::string& keystore, const std::string& enclave,
              const std::function<void()>& meanwhile) {
  wire::ParticipantOptions options;
  options.node = {support::test_namespace(), "stranger"};
  wire::Discovery discovery;
  discovery.domain_id = support::test_domain();
  discovery.range = wire::DiscoveryRange::localhost;
  options.discovery = discovery;
  options.security = {keystore, enclave};
  const auto participant = wire::Participant::create(std::move(options));
  EXPECT_TRUE(participant.ok()) << participant.status().message;
  if (!participant.ok()) return {};

  std::atomic<int> heard{0};
  const auto hear = [&heard](auto&&, const wire::SampleMeta&) { ++heard; };
  wire::SubscriberOptions latched;
  latched.qos = wire::qos::latched();
  const auto results = wire::Subscriber<msgs::SceneInterpretations>::create(
      *participant, "interpretations", {}, hear);
  const auto info = wire::Subscriber<wire::vision_msgs::VisionInfo>::create(
      *participant, "vision_info", latched, hear);
  wire::PublisherOptions sending;
  sending.qos = wire::qos::frames();
  auto frames = wire::Publisher<msgs::RgbdFrame>::create(*participant, "frames", sending);
  const auto models = wire::ServiceClient<msgs::ListModels>::create(*participant, "list_models");
  const auto parameters =
      wire::ServiceClient<rcl::SetParameters>::create(*participant, "server/set_parameters");
  const bool has_all = results.ok() && info.ok() && frames.ok() && models.ok() && parameters.ok();
  EXPECT_TRUE(has_all);
  if (!has_all) return {};

  const auto matched = [&] { return frames->matched_count() + results->matched_count() > 0; };
  becomes_true(matched);
  for (std::uint32_t i = 0; i < 20; ++i) {
    auto frame = support::wall_frame();
    EXPECT_TRUE(frames->publish(frame).ok());
    std::this_thread::sleep_for(milliseconds(50));
  }
  Reach reach;
  reach.answered = models->call({}, milliseconds(2000)).ok();
  rcl::SetParameters_Request set;
  set.parameters.resize(1);
  set.parameters[0].name = "queue.requests";
  set.parameters[0].value.type = rcl::ParameterType::kInteger;
  set.parameters[0].value.integer_value = kQueueCapacity + 1;
  (void)parameters->call(set, milliseconds(1000)).ok();
  meanwhile();
  reach.read = becomes_true([&] { return heard > 0; }, milliseconds(1000));
  reach.matched = matched();
  return reach;
}

void expect_nothing(const Reach& reach) {
  EXPECT_FALSE(reach.matched);
  EXPECT_FALSE(reach.read);
  EXPECT_FALSE(reach.answered);
}

/// Without a keystore, where nothing keeps the stranger out.
TEST(Strangers, DoAllOfItWithoutSecurity) {
  support::StubServer server(settings_with(""));
  auto client = connect("", "/");
  ASSERT_TRUE(client.ok()) << client.status().message << server.log();
  const Spy spy(support::test_domain());
  const Reach reach = try_all("", "/", [] {});
  EXPECT_TRUE(reach.matched && reach.read && reach.answered) << server.log();
  const auto status = client->status();
  ASSERT_TRUE(status.ok()) << status.status().message << server.log();
  EXPECT_GT(status->frames_received, 0U) << server.log();
  EXPECT_GT(status->queue_capacity, kQueueCapacity) << server.log();
  EXPECT_GT(spy.topics().count(wire::dds_topic_name(support::test_namespace() + "/frames")), 0U);
}

TEST_F(Secured, RobotSendsReadsAndCalls) {
  const support::WallView wall;
  const auto found = robot().detect_in(wall.view());
  ASSERT_TRUE(found.ok()) << found.status().message << log();
  EXPECT_EQ(found->best().size(), 1U);
  const auto results = std::make_shared<std::atomic<int>>(0);  // the robot outlives this test
  ASSERT_TRUE(robot().subscribe([results](const DetectionSet&) { ++*results; }).ok());
  robot_sends();
  EXPECT_TRUE(becomes_true([&] { return *results > 0; })) << log();
  expect_unchanged(1, 1);
}

TEST_F(Secured, ViewerReadsAndNeitherSendsNorCalls) {
  std::atomic<int> results{0};
  auto viewer = connect(ours(), "/viewer");
  ASSERT_TRUE(viewer.ok()) << viewer.status().message << log();
  ASSERT_TRUE(viewer->subscribe([&](const DetectionSet&) { ++results; }).ok());
  robot_sends();
  EXPECT_TRUE(becomes_true([&] { return results > 0; })) << log();

  const support::WallView wall;
  const Status refused[] = {viewer->status().status(), viewer->models().status(),
                            viewer->unload_model("stub"), viewer->detect().status(),
                            viewer->publish_frame(wall.view(3'000))};
  for (const Status& status : refused) {
    EXPECT_EQ(status.code, StatusCode::unsupported) << status.message;
    EXPECT_NE(status.message.find("permissions of enclave /viewer"), std::string::npos)
        << status.message;
  }
  expect_unchanged(1, 0);
}

TEST_F(Secured, OneWithoutSecurityGetsNothing) {
  {
    const Spy spy(support::test_domain());  // alone: it would see the topics of another stranger
    std::this_thread::sleep_for(kPatience);
    EXPECT_EQ(spy.topics(), std::set<std::string>());
  }
  expect_nothing(try_all("", "/", [this] { robot_sends(); }));
  expect_unchanged(1, 0);
}

/// The other authority has the same name, so only its signature tells it from ours.
TEST_F(Secured, OneOfAnotherAuthorityGetsNothing) {
  expect_nothing(try_all(make_keystore("theirs"), "/robot", [this] { robot_sends(); }));
  expect_unchanged(1, 0);
}

/// A viewer that gives itself the permissions of a robot, signed by an authority of its own.
TEST_F(Secured, OneThatSignsItsOwnPermissionsGetsNothing) {
  const std::string forged = support::scratch_folder() + "/forged";
  fs::remove_all(forged);
  fs::copy(make_keystore("theirs"), forged, fs::copy_options::recursive);
  for (const char* file : {"identity_ca.cert.pem", "cert.pem", "key.pem"}) {
    fs::copy_file(ours() + "/enclaves/robot/" + file, forged + "/enclaves/robot/" + file,
                  fs::copy_options::overwrite_existing);
  }
  expect_nothing(try_all(forged, "/robot", [this] { robot_sends(); }));
  expect_unchanged(1, 0);
}

/// Permissions hold for one domain: elsewhere the server does not even start, rather than
/// unguarded.
TEST(Strangers, KeystoreOfAnotherDomainIsRefused) {
  const std::string other = make_keystore("other_domain", support::test_domain() + 100);
  support::StubServer server(settings_with(other));
  EXPECT_EQ(server.process().wait(seconds(10)), 1) << server.log();
  EXPECT_NE(server.log().find("permissions of enclave /bpa_server"), std::string::npos)
      << server.log();
}

}  // namespace
}  // namespace bpa::test
