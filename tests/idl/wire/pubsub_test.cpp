// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/idl/wire/domain.hpp"

namespace bpa::wire {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Collects what callbacks say.
template <class T>
class Inbox {
 public:
  void put(T value) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      values_.push_back(std::move(value));
    }
    changed_.notify_all();
  }
  bool wait_for(std::size_t count, seconds timeout = seconds(5)) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, timeout, [&] { return values_.size() >= count; });
  }
  std::vector<T> values() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return values_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> values_;
};

bpa_msgs::RgbdFrame frame_of(std::uint32_t width, std::uint32_t height) {
  bpa_msgs::RgbdFrame frame;
  frame.header.stamp = {12, 34};
  frame.header.frame_id = "camera";
  frame.width = width;
  frame.height = height;
  frame.color_encoding = "rgb8";
  frame.color.resize(3U * width * height);
  for (std::size_t i = 0; i < frame.color.size(); ++i) {
    frame.color[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  }
  frame.depth_encoding = "16UC1";
  frame.depth.assign(2U * width * height, 3);
  frame.k = {500, 0, 320, 0, 500, 240, 0, 0, 1};
  return frame;
}

TEST(PubSub, FramesArriveAsTheyWereSent) {
  auto one = test_participant("one");
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  PublisherOptions publisher_options;
  publisher_options.qos = qos::frames();
  auto publisher = Publisher<bpa_msgs::RgbdFrame>::create(*one, "frames", publisher_options);
  ASSERT_TRUE(publisher.ok()) << publisher.status().message;
  Inbox<bpa_msgs::RgbdFrame> inbox;
  SubscriberOptions subscriber_options;
  subscriber_options.qos = qos::reliable_input();
  auto subscriber = Subscriber<bpa_msgs::RgbdFrame>::create(
      *two, "/frames", subscriber_options,
      [&inbox](bpa_msgs::RgbdFrame&& frame, const SampleMeta& meta) {
        EXPECT_NE(meta.source_time_ns, 0);
        inbox.put(std::move(frame));
      });
  ASSERT_TRUE(subscriber.ok()) << subscriber.status().message;
  ASSERT_TRUE(publisher->wait_for_matched(seconds(5)));
  ASSERT_TRUE(subscriber->wait_for_matched(seconds(5)));
  EXPECT_EQ(publisher->matched_count(), 1U);

  const bpa_msgs::RgbdFrame frame = frame_of(640, 480);
  constexpr std::size_t kFrames = 20;
  for (std::size_t i = 0; i < kFrames; ++i) {
    bpa_msgs::RgbdFrameView view;
    view.header = frame.header;
    view.header.stamp.sec = static_cast<int>(i);
    view.width = frame.width;
    view.height = frame.height;
    view.color_encoding = frame.color_encoding;
    view.color = {frame.color.data(), frame.color.size()};
    view.depth_encoding = frame.depth_encoding;
    view.depth = {frame.depth.data(), frame.depth.size()};
    view.k = frame.k;
    const Status status = publisher->publish(view);
    ASSERT_TRUE(status.ok()) << status.message;
    ASSERT_TRUE(inbox.wait_for(i + 1)) << i;
  }
  const auto frames = inbox.values();
  for (std::size_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(frames[i].header.stamp.sec, static_cast<int>(i));
    EXPECT_EQ(frames[i].header.frame_id, "camera");
    EXPECT_EQ(frames[i].color, frame.color);
    EXPECT_EQ(frames[i].depth, frame.depth);
    EXPECT_EQ(frames[i].k, frame.k);
  }
  EXPECT_EQ(subscriber->statistics().received, kFrames);
  EXPECT_EQ(subscriber->statistics().malformed, 0U);
}

TEST(PubSub, LargeDatagramsOfOthersAreReceivedWhole) {
  ParticipantOptions large;
  large.node.name = "large";
  large.discovery = test_discovery();
  large.datagram_bytes = 65500;
  auto one = Participant::create(std::move(large));
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  for (auto* const sender : {&*one, &*two}) {
    Inbox<std::size_t> inbox;
    auto publisher = Publisher<bpa_msgs::RgbdFrame>::create(*sender, "frames", {qos::frames()});
    const auto subscriber = Subscriber<bpa_msgs::RgbdFrame>::create(
        sender == &*one ? *two : *one, "frames", {qos::frames()},
        [&](bpa_msgs::RgbdFrame&& frame, const SampleMeta&) { inbox.put(frame.color.size()); });
    ASSERT_TRUE(publisher.ok() && subscriber.ok());
    ASSERT_TRUE(publisher->wait_for_matched(seconds(5)));
    ASSERT_TRUE(subscriber->wait_for_matched(seconds(5)));
    ASSERT_TRUE(publisher->publish(frame_of(320, 240)).ok());
    ASSERT_TRUE(inbox.wait_for(1));
    EXPECT_EQ(inbox.values()[0], 3U * 320 * 240);
  }
}

TEST(PubSub, LateSubscriberGetsWhatIsLatched) {
  auto one = test_participant("one");
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  PublisherOptions options;
  options.qos = qos::latched();
  auto publisher = Publisher<vision_msgs::VisionInfo>::create(*one, "vision_info", options);
  ASSERT_TRUE(publisher.ok());
  vision_msgs::VisionInfo info;
  info.method = "bpa";
  info.database_version = 7;
  ASSERT_TRUE(publisher->publish(info).ok());
  Inbox<vision_msgs::VisionInfo> inbox;
  SubscriberOptions subscriber_options;
  subscriber_options.qos = qos::latched();
  auto subscriber = Subscriber<vision_msgs::VisionInfo>::create(
      *two, "vision_info", subscriber_options,
      [&inbox](vision_msgs::VisionInfo&& got, const SampleMeta&) { inbox.put(std::move(got)); });
  ASSERT_TRUE(subscriber.ok());
  ASSERT_TRUE(inbox.wait_for(1));
  EXPECT_EQ(inbox.values()[0].database_version, 7);
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(PubSub, MismatchesAreLoggedWithTheRemedy) {
  Inbox<std::string> log;
  const LogHook hook = [&log](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) log.put(std::string(text));
  };
  auto one = test_participant("one", hook);
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  PublisherOptions best_effort;
  best_effort.qos.reliability = Reliability::best_effort;
  auto image = Publisher<sensor_msgs::Image>::create(*one, "image", best_effort);
  auto text = Publisher<std_msgs::String>::create(*one, "text");
  ASSERT_TRUE(image.ok() && text.ok());
  SubscriberOptions reliable;
  reliable.qos = qos::reliable_input();
  auto image_subscriber = Subscriber<sensor_msgs::Image>::create(
      *two, "image", reliable, [](sensor_msgs::Image&&, const SampleMeta&) {});
  auto other_type = Subscriber<std_msgs::Header>::create(
      *two, "text", reliable, [](std_msgs::Header&&, const SampleMeta&) {});
  ASSERT_TRUE(image_subscriber.ok() && other_type.ok());
  ASSERT_TRUE(log.wait_for(2));
  std::string all;
  for (const std::string& line : log.values()) all += line + "\n";
  EXPECT_TRUE(contains(all, "rt/image")) << all;
  EXPECT_TRUE(contains(all, "reliability")) << all;
  EXPECT_TRUE(contains(all, "best_effort")) << all;
  EXPECT_TRUE(contains(all, "std_msgs::msg::dds_::Header_")) << all;
  EXPECT_EQ(image->matched_count(), 0U);
  for (int i = 0; i < 100 && image_subscriber->statistics().incompatible == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(image_subscriber->statistics().incompatible, 1U);
}

/// The peer was there first: what is known of it is looked at when our endpoint comes.
TEST(PubSub, AnotherTypeIsLoggedWhoeverComesFirst) {
  Inbox<std::string> log;
  const LogHook hook = [&log](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) log.put(std::string(text));
  };
  auto one = test_participant("one", hook);
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  auto marker = Publisher<std_msgs::String>::create(*one, "marker");
  auto other_type = Subscriber<std_msgs::Header>::create(
      *two, "late", {}, [](std_msgs::Header&&, const SampleMeta&) {});
  auto marked = Subscriber<std_msgs::String>::create(*two, "marker", {},
                                                     [](std_msgs::String&&, const SampleMeta&) {});
  ASSERT_TRUE(marker->wait_for_matched(seconds(10)));  // so that one knows of two's other endpoint
  auto text = Publisher<std_msgs::String>::create(*one, "late");
  ASSERT_TRUE(text.ok());
  ASSERT_TRUE(log.wait_for(1));
  EXPECT_TRUE(contains(log.values()[0], "rt/late")) << log.values()[0];
  EXPECT_TRUE(contains(log.values()[0], "std_msgs::msg::dds_::Header_")) << log.values()[0];
}

/// Whether two participants with this range find each other.
bool find_each_other(DiscoveryRange range, std::vector<std::string> peers, milliseconds patience) {
  ParticipantOptions options;
  options.discovery = test_discovery();
  options.discovery->range = range;
  options.discovery->static_peers = std::move(peers);
  auto one = Participant::create(options);
  auto two = Participant::create(options);
  EXPECT_TRUE(one.ok() && two.ok());
  auto publisher = Publisher<std_msgs::String>::create(*one, "text");
  auto subscriber = Subscriber<std_msgs::String>::create(
      *two, "text", {}, [](std_msgs::String&&, const SampleMeta&) {});
  return publisher->wait_for_matched(patience);
}

TEST(PubSub, RangesOfDiscovery) {
  EXPECT_TRUE(find_each_other(DiscoveryRange::localhost, {}, seconds(5)));
  EXPECT_TRUE(find_each_other(DiscoveryRange::localhost, {"127.0.0.1"}, seconds(5)));
  EXPECT_TRUE(find_each_other(DiscoveryRange::humble_localhost, {}, seconds(5)));
  EXPECT_FALSE(find_each_other(DiscoveryRange::off, {}, milliseconds(300)));
}

// Discovery by unicast tries the ports of the first 32 participants of a host.
TEST(PubSub, AProgramThatJoinsOftenIsStillFound) {
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(test_participant("joins_often").ok());
  EXPECT_TRUE(find_each_other(DiscoveryRange::localhost, {}, seconds(5)));
}

TEST(PubSub, MatchesComeAndGo) {
  auto one = test_participant("one");
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  auto publisher = Publisher<std_msgs::String>::create(*one, "text");
  ASSERT_TRUE(publisher.ok());
  EXPECT_FALSE(publisher->wait_for_matched(milliseconds(20)));
  {
    auto subscriber = Subscriber<std_msgs::String>::create(
        *two, "text", {}, [](std_msgs::String&&, const SampleMeta&) {});
    ASSERT_TRUE(subscriber.ok());
    EXPECT_TRUE(publisher->wait_for_matched(seconds(5)));
  }
  for (int i = 0; i < 100 && publisher->matched_count() > 0; ++i) usleep(20'000);
  EXPECT_EQ(publisher->matched_count(), 0U);
}

TEST(PubSub, MalformedSamplesAreCountedAndTheNextIsRead) {
  Inbox<std::string> log;
  auto one = test_participant("one");
  auto two = test_participant("two", [&log](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) log.put(std::string(text));
  });
  ASSERT_TRUE(one.ok() && two.ok());
  auto spec = detail::endpoint_spec<sensor_msgs::Image>("rt/image", qos::results());
  auto writer = detail::make_writer(*one, spec);
  ASSERT_TRUE(writer.ok());
  Inbox<std::uint32_t> heights;
  SubscriberOptions options;
  options.qos = qos::reliable_input();
  auto subscriber = Subscriber<sensor_msgs::Image>::create(
      *two, "image", options,
      [&heights](sensor_msgs::Image&& image, const SampleMeta&) { heights.put(image.height); });
  ASSERT_TRUE(subscriber.ok());
  ASSERT_TRUE(writer.value()->matches().wait_for(1, seconds(5)));
  sensor_msgs::Image image;
  image.height = 5;
  std::vector<std::uint8_t> bytes = encode(image);
  bytes.back() = 0x7f;  // 2 GB of pixels
  ASSERT_TRUE(writer.value()->write(detail::bytes_ref(bytes), nullptr, nullptr).ok());
  ASSERT_TRUE(writer.value()->write(detail::message_ref(image), nullptr, nullptr).ok());
  ASSERT_TRUE(heights.wait_for(1));
  EXPECT_EQ(subscriber->statistics().malformed, 1U);
  EXPECT_EQ(subscriber->statistics().received, 1U);
  ASSERT_TRUE(log.wait_for(1));
  EXPECT_TRUE(contains(log.values()[0], "rt/image") && contains(log.values()[0], "data"))
      << log.values()[0];
}

TEST(PubSub, TheGraphShowsTheNodeAndItsEndpoints) {
  using Info = rmw_dds_common::ParticipantEntitiesInfo;
  auto one = test_participant("one");
  auto two = test_participant("two");
  ASSERT_TRUE(one.ok() && two.ok());
  Inbox<Info> graph;
  auto spec = detail::endpoint_spec<Info>("ros_discovery_info", qos::latched());
  spec.in_graph = false;
  auto reader = detail::make_reader(
      *two, spec,
      [&graph](const std::uint8_t* bytes,
               std::size_t size) -> Result<std::function<void(const SampleMeta&)>> {
        auto info = std::make_shared<Info>();
        Status status = decode(bytes, size, *info);
        if (!status.ok()) return status;
        return std::function<void(const SampleMeta&)>([&graph, info](const SampleMeta&) {
          const auto& nodes = info->node_entities_info_seq;
          if (nodes.size() == 1 && nodes[0].node_name == "one") graph.put(*info);
        });
      });
  ASSERT_TRUE(reader.ok());
  ASSERT_TRUE(graph.wait_for(1));
  auto writer =
      detail::make_writer(*one, detail::endpoint_spec<std_msgs::String>("rt/text", qos::results()));
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(graph.wait_for(2));
  const Guid guid = writer.value()->guid();
  writer.value().reset();
  ASSERT_TRUE(graph.wait_for(3));
  const auto states = graph.values();
  EXPECT_EQ(states[0].node_entities_info_seq[0].node_namespace, "/");
  EXPECT_TRUE(states[0].node_entities_info_seq[0].writer_gid_seq.empty());
  ASSERT_EQ(states[1].node_entities_info_seq[0].writer_gid_seq.size(), 1U);
  EXPECT_EQ(states[1].node_entities_info_seq[0].writer_gid_seq[0].data, guid);
  EXPECT_TRUE(states[2].node_entities_info_seq[0].writer_gid_seq.empty());
  EXPECT_TRUE(std::equal(guid.begin(), guid.begin() + 12, states[0].gid.data.begin()));
}

TEST(PubSub, OneTopicTwoTypesInOneProcessIsRefused) {
  auto one = test_participant("one");
  ASSERT_TRUE(one.ok());
  auto text = Publisher<std_msgs::String>::create(*one, "x");
  auto header = Publisher<std_msgs::Header>::create(*one, "x");
  ASSERT_TRUE(text.ok());
  ASSERT_FALSE(header.ok());
  EXPECT_TRUE(contains(header.status().message, "std_msgs::msg::dds_::String_"));
}

}  // namespace
}  // namespace bpa::wire
