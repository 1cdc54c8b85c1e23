// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/feed.hpp"

#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace bpa::server::web {
namespace {

using Json = nlohmann::json;

Frame frame_of(int width, int height) {
  Frame frame;
  frame.camera = {width, height, 60, 60, 0.5 * width, 0.5 * height};
  frame.depth.assign(static_cast<std::size_t>(width * height), 1.5f);
  return frame;
}

SceneInterpretations result_of(const std::string& model) {
  Placement placement;
  placement.model = model;
  placement.probability = placement.presence = 0.75;
  SceneInterpretations result;
  result.stamp_ns = 123;
  result.interpretations.push_back({1, 0, 1, {placement}});
  result.timings = {{"first", 2}, {"again", 1}};
  result.total_milliseconds = 3;
  return result;
}

TEST(Feed, KeepsAndDecodesNothingWhileNobodyLooks) {
  Feed feed(20, [] { return 7; });
  int decoded = 0;
  const auto shared = std::make_shared<SharedFrame>(Once<ros::DecodedFrame>([&decoded] {
    ++decoded;
    return ros::DecodedFrame(frame_of(64, 48));
  }));
  feed.add_frame(shared, 1, "camera");
  feed.add_result(frame_of(64, 48), result_of("mug"));
  feed.add_tracks({});
  EXPECT_FALSE(feed.wanted());
  EXPECT_EQ(feed.sequence(), 1U);
  EXPECT_FALSE(feed.camera_frame());
  EXPECT_TRUE(feed.results_after(0).empty());
  EXPECT_EQ(decoded, 0);

  ASSERT_TRUE(feed.see("viewer", false).ok());
  feed.add_frame(shared, 1, "camera");
  ASSERT_TRUE(feed.camera_frame());
  EXPECT_EQ(decoded, 0);  // until a picture is asked for
  const auto picture = feed.camera_frame()->shown->depth();
  ASSERT_TRUE(picture.ok()) << picture.status().message;
  EXPECT_TRUE((*picture)->starts_with("\xff\xd8\xff"));  // JPEG
  EXPECT_EQ(decoded, 1);
  EXPECT_EQ(*feed.camera_frame()->shown->depth(), *picture);  // the very same bytes
}

TEST(Feed, ShowsAdviceBesideTheResultAndNotInItsPlan) {
  Feed feed(20, [] { return 7; });
  ASSERT_TRUE(feed.see("viewer", false).ok());
  feed.add_result(frame_of(64, 48), result_of("mug"), "it is dark");
  const Json shown = Json::parse(feed.results_after(0).at(0)->json());
  EXPECT_EQ(shown.at("advice"), "it is dark");
  EXPECT_EQ(shown.at("result").dump().find("it is dark"), std::string::npos);
}

TEST(Feed, ForgetsAViewerThatDoesNotAskAgain) {
  Feed feed(20, [] { return 7; });
  ASSERT_TRUE(feed.see("viewer", true).ok());
  EXPECT_TRUE(feed.tracks_wanted());
  feed.add_result(frame_of(64, 48), result_of("mug"));
  EXPECT_EQ(feed.results_after(0).size(), 1U);
  std::this_thread::sleep_for(Feed::kViewerPatience + std::chrono::milliseconds(100));
  EXPECT_FALSE(feed.wanted());
  EXPECT_FALSE(feed.tracks_wanted());
  feed.tidy();
  EXPECT_TRUE(feed.results_after(0).empty());
  EXPECT_EQ(feed.counts().viewers, 0U);
  EXPECT_EQ(feed.counts().viewers_gone, 1U);
}

TEST(Feed, KeepsTheLastResults) {
  Feed feed(3, [] { return 7; });
  ASSERT_TRUE(feed.see("viewer", false).ok());
  for (const char* name : {"a", "b", "c", "d"}) {
    feed.add_result(frame_of(64, 48), result_of(name));
  }
  const auto kept = feed.results_after(0);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0]->id, 2U);
  EXPECT_EQ(feed.results_after(3).size(), 1U);
  EXPECT_EQ(feed.result(1), nullptr);
  const Json summary = Json::parse(feed.result(4)->summary());
  EXPECT_EQ(summary.at("objects"), Json::parse(R"([["d", 0.75]])"));
  EXPECT_EQ(summary.at("stages"), Json::parse(R"([["first", 2.0], ["again", 1.0]])"));
  const Json all = Json::parse(feed.result(4)->json());
  EXPECT_EQ(all.at("camera").at("width"), 64);
  EXPECT_EQ(all.at("result").at("stamp_ns"), 123);
}

TEST(Feed, KeepsAResultWhileAViewerHoldsIt) {
  Feed feed(2, [] { return 7; });
  ASSERT_TRUE(feed.see("one", false, 1).ok());
  ASSERT_TRUE(feed.see("another", false, 3).ok());
  const auto ids = [&feed] {
    std::vector<std::uint64_t> kept;
    for (const auto& result : feed.results_after(0)) kept.push_back(result->id);
    return kept;
  };
  for (int i = 0; i < 6; ++i) feed.add_result(frame_of(64, 48), result_of("mug"));
  EXPECT_EQ(ids(), (std::vector<std::uint64_t>{1, 3, 5, 6}));
  ASSERT_TRUE(feed.see("one", false).ok());
  feed.add_result(frame_of(64, 48), result_of("mug"));
  EXPECT_EQ(ids(), (std::vector<std::uint64_t>{3, 6, 7}));
}

TEST(Feed, KeepsTheResultThatAViewerWasToldOfLast) {
  Feed feed(2, [] { return 7; });
  ASSERT_TRUE(feed.see("viewer", false).ok());
  feed.add_result(frame_of(64, 48), result_of("mug"));
  ASSERT_EQ(feed.tell("viewer", 0).size(), 1U);
  for (int i = 0; i < 5; ++i) feed.add_result(frame_of(64, 48), result_of("mug"));
  EXPECT_TRUE(feed.result(1));
  ASSERT_EQ(feed.tell("viewer", 1).back()->id, 6U);
  feed.add_result(frame_of(64, 48), result_of("mug"));
  EXPECT_FALSE(feed.result(1));
}

TEST(Feed, HasRoomForSomeViewers) {
  Feed feed(3, [] { return 7; });
  for (int i = 0; i < 16; ++i) EXPECT_TRUE(feed.see(std::to_string(i), false).ok());
  EXPECT_EQ(feed.see("one more", false).code, StatusCode::busy);
  EXPECT_TRUE(feed.see("3", false).ok());  // is there already
  EXPECT_EQ(feed.see("", false).code, StatusCode::invalid_argument);
  EXPECT_EQ(feed.see(std::string(41, 'a'), false).code, StatusCode::invalid_argument);
}

TEST(Feed, CountsFramesThatNoViewerHeardOf) {
  Feed feed(3, [] { return 7; });
  ASSERT_TRUE(feed.see("viewer", false).ok());
  for (int i = 0; i < 4; ++i) {
    feed.add_frame(std::make_shared<SharedFrame>(
                       Once<ros::DecodedFrame>([] { return ros::DecodedFrame(frame_of(64, 48)); })),
                   i, "camera");
    if (i == 1) (void)feed.camera_frame();
  }
  EXPECT_EQ(feed.counts().frames_unseen, 2U);  // the first and the third
}

}  // namespace
}  // namespace bpa::server::web
