// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/search_queue.hpp"

#include <atomic>
#include <optional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/gated_search_queue.hpp"

namespace bpa::server {
namespace {

using std::chrono::milliseconds;

TEST_F(SearchQueueTest, NewestFrameWinsAndDropsAreCounted) {
  auto queue = make();
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  for (int stamp = 1; stamp <= 9; ++stamp) queue->push(frame(stamp));
  EXPECT_EQ(queue->length(), 1U);
  gate.open();
  ASSERT_TRUE(streamed.wait_for(2));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 9}));
  const Counts counts = statistics.counts();
  EXPECT_EQ(counts.frames_received, 10U);
  EXPECT_EQ(counts.frames_dropped, 8U);
  EXPECT_EQ(counts.frames_processed, 2U);
}

TEST_F(SearchQueueTest, FullQueueOfRequestsIsBusyAndFramesDoNotCount) {
  SearchQueueOptions options;
  options.request_capacity = 2;
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  queue->push(frame(1));
  EXPECT_TRUE(queue->push(job(true)).ok());
  EXPECT_TRUE(queue->push(job(false)).ok());
  EXPECT_EQ(queue->push(job(true)).code, StatusCode::busy);
  gate.open();
  ASSERT_TRUE(answers.wait_for(2));
  EXPECT_EQ(answers.code(0), StatusCode::ok);
  EXPECT_EQ(answers.code(1), StatusCode::ok);
  EXPECT_EQ(statistics.counts().requests_served, 2U);
}

TEST_F(SearchQueueTest, AGreedyClientMakesRoomForOthers) {
  SearchQueueOptions options;
  options.request_capacity = 4;
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  const auto ask = [&](std::uint8_t client, bool with_frame = true) {
    return queue->push(job(with_frame, milliseconds(5000), client, client)).code;
  };
  EXPECT_EQ(ask(1), StatusCode::ok);
  EXPECT_EQ(ask(1, false), StatusCode::ok);
  EXPECT_EQ(ask(1), StatusCode::ok);
  EXPECT_EQ(ask(1, false), StatusCode::ok);
  EXPECT_EQ(ask(1), StatusCode::busy);
  EXPECT_EQ(answers.size(), 0U);
  EXPECT_EQ(ask(2), StatusCode::ok);  // of client 1 there are three left
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers.code(0), StatusCode::busy);
  EXPECT_EQ(ask(2, false), StatusCode::ok);  // two each
  EXPECT_EQ(ask(2), StatusCode::busy);
  EXPECT_EQ(ask(1), StatusCode::busy);
  EXPECT_EQ(ask(3), StatusCode::ok);
  EXPECT_EQ(ask(4), StatusCode::ok);  // one each
  EXPECT_EQ(ask(5), StatusCode::busy);
  EXPECT_EQ(queue->length(), 4U);
  EXPECT_EQ(statistics.counts().requests_refused, 4U);  // the callers count the other four
  gate.open();
  queue->push(frame(1));
  ASSERT_TRUE(answers.wait_for(8));
  for (std::size_t i = 4; i < 8; ++i) EXPECT_EQ(answers.code(i), StatusCode::ok);
}

TEST_F(SearchQueueTest, FramesAndRequestsTakeTurns) {
  SearchQueueOptions options;
  options.frame_capacity = 10;
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  for (int i = 1; i <= 3; ++i) queue->push(frame(i));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(queue->push(job(true)).ok());
  gate.open();
  ASSERT_TRUE(answers.wait_for(3));
  ASSERT_TRUE(streamed.wait_for(4));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 77, 1, 77, 2, 77, 3}));
}

TEST_F(SearchQueueTest, ClientsTakeTurnsAndLearnTheirPlace) {
  auto queue = make();
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  for (int i = 0; i < 3; ++i) {  // client 1 asks three times before anybody else
    ASSERT_TRUE(queue->push(job(true, milliseconds(5000), 1, 10 + i)).ok());
  }
  ASSERT_TRUE(queue->push(job(true, milliseconds(5000), 2, 20)).ok());
  ASSERT_TRUE(queue->push(job(true, milliseconds(5000), 3, 30)).ok());
  gate.open();
  ASSERT_TRUE(answers.wait_for(5));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 10, 20, 30, 11, 12}));
  EXPECT_EQ(answers.positions(), (std::vector<std::size_t>{0, 1, 2, 1, 2}));
}

TEST_F(SearchQueueTest, ARequestThatCannotBeServedInTimeIsRefusedAtOnce) {
  SearchQueueOptions options;
  options.continuous = false;
  auto queue = make(options);
  SceneInterpretations second_long;
  second_long.total_milliseconds = 1000;
  statistics.add_timings(second_long);
  EXPECT_EQ(queue->push(job(true, milliseconds(300))).code, StatusCode::timeout);
  EXPECT_EQ(queue->push(job(false, milliseconds(300))).code, StatusCode::timeout);
  DetectJob quick = job(true, milliseconds(300));  // the best that 100 ms can give
  quick.request.budget_ms = 100;
  EXPECT_TRUE(queue->push(std::move(quick)).ok());
  ASSERT_TRUE(gate.wait_for_started(1));
  // Behind a search that has just begun and one that waits there is no time for 1.5 s.
  ASSERT_TRUE(queue->push(job(true, milliseconds(5000))).ok());
  quick = job(true, milliseconds(1500));
  quick.request.budget_ms = 100;
  EXPECT_EQ(queue->push(std::move(quick)).code, StatusCode::timeout);
  EXPECT_TRUE(queue->push(job(true, milliseconds(5000))).ok());
  gate.open();
  ASSERT_TRUE(answers.wait_for(3));
}

TEST_F(SearchQueueTest, OptionsChangeWhileItRuns) {
  auto queue = make();
  gate.open();
  queue->push(frame(1));
  ASSERT_TRUE(streamed.wait_for(1));
  SearchQueueOptions paused;
  paused.continuous = false;
  queue->set_options(paused);
  queue->push(frame(2));
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{1, 77}));
  queue->set_options({});  // the frame that waits is searched now
  ASSERT_TRUE(streamed.wait_for(2));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{1, 77, 2}));
}

TEST_F(SearchQueueTest, NextFrameRequestsShareTheStreamsSearch) {
  auto queue = make();
  gate.open();
  ASSERT_TRUE(queue->push(job(false)).ok());
  ASSERT_TRUE(queue->push(job(false)).ok());
  queue->push(bad_frame());  // they go on waiting
  ASSERT_TRUE(streamed.wait_for(1));
  EXPECT_EQ(answers.size(), 0U);
  queue->push(frame(5));
  ASSERT_TRUE(answers.wait_for(2));
  EXPECT_EQ(gate.stamps(), std::vector<std::int64_t>{5});
  EXPECT_EQ(statistics.counts().frames_rejected, 1U);
  ASSERT_EQ(statistics.rejections().size(), 1U);
  EXPECT_EQ(statistics.rejections().front(), std::pair(std::string("depth"), std::uint64_t{1}));
}

TEST_F(SearchQueueTest, FramesBringTheirPriors) {
  auto queue = make();
  gate.open();
  DetectJob own = job(false);
  own.request.priors.resize(1);
  own.request.priors[0].model = "mug";
  own.restrict_frame = [](Frame&) { return Status(); };  // as requests with priors have it
  ASSERT_TRUE(queue->push(std::move(own)).ok());
  IncomingFrame tracked = frame(5);
  tracked.priors.resize(1);
  tracked.priors[0].model = "bowl";
  queue->push(std::move(tracked));
  ASSERT_TRUE(answers.wait_for(1));
  queue->push(frame(6));
  ASSERT_TRUE(streamed.wait_for(2));
  EXPECT_EQ(gate.priors(), (std::vector<std::string>{"bowl ", "mug bowl ", ""}));
}

TEST_F(SearchQueueTest, AFrameIsSearchedForWhatItsCameraShowedBefore) {
  gate.open();
  auto queue = make();
  const auto of_camera = [](std::int64_t stamp, const std::string& camera) {
    IncomingFrame incoming = frame(stamp);
    incoming.decode = [stamp, camera] {
      auto message = support::wall_frame(stamp);
      message.header.frame_id = camera;
      return ros::frame_from_message(message);
    };
    return incoming;
  };
  int searched = 0;
  const auto search = [&](IncomingFrame incoming) {
    queue->push(std::move(incoming));
    ASSERT_TRUE(streamed.wait_for(static_cast<std::size_t>(++searched)));
  };
  search(of_camera(1, "left"));
  search(of_camera(2, "right"));
  search(of_camera(3, "left"));
  SearchQueueOptions options;
  options.follow = false;
  queue->set_options(options);
  search(of_camera(4, "left"));
  options.follow = true;
  options.request.seed = 666;  // the search fails
  queue->set_options(options);
  search(of_camera(5, "left"));
  options.request.seed = 0;
  queue->set_options(options);
  search(of_camera(6, "left"));
  EXPECT_EQ(gate.expected(),
            (std::vector<std::string>{"", "", "found at 1", "", "found at 4", ""}));
}

TEST_F(SearchQueueTest, ASearchBeginsWithWhereTheTracksAre) {
  SearchQueueOptions options;
  bool tracked = false;
  options.expected = [&](const std::string&) -> std::optional<std::vector<ExpectedPlacement>> {
    if (!tracked) return std::nullopt;
    return std::vector<ExpectedPlacement>{{"a track", {}}};
  };
  auto queue = make(options);
  gate.open();
  std::vector<std::int64_t> taken;
  for (const int stamp : {1, 2, 3}) {
    IncomingFrame incoming = frame(stamp);
    incoming.taken = [&taken, stamp] { taken.push_back(stamp); };
    queue->push(std::move(incoming));
    ASSERT_TRUE(streamed.wait_for(static_cast<std::size_t>(stamp)));
    tracked = stamp == 1;
  }
  queue.reset();
  EXPECT_EQ(gate.expected(), (std::vector<std::string>{"", "a track", "found at 2"}));
  EXPECT_EQ(taken, (std::vector<std::int64_t>{1, 2, 3}));
}

TEST_F(SearchQueueTest, FramesThatWaitAreCombinedAndTheNewestIsSearched) {
  SearchQueueOptions options;
  options.fuse_frames = options.frame_capacity = 3;
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  for (int stamp = 1; stamp <= 4; ++stamp) queue->push(frame(stamp));
  ASSERT_TRUE(queue->push(job(false)).ok());
  gate.open();
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 4}));
  EXPECT_EQ(gate.fused(), (std::vector<int>{1, 3}));
  const Counts counts = statistics.counts();
  EXPECT_EQ(counts.frames_received, 5U);
  EXPECT_EQ(counts.frames_dropped, 1U);
  EXPECT_EQ(counts.frames_fused, 2U);
  EXPECT_EQ(counts.frames_processed, 2U);
  EXPECT_EQ(counts.fusion_restarts, 0U);

  ASSERT_TRUE(queue->push(job(true)).ok());  // its own frame is its own affair
  ASSERT_TRUE(answers.wait_for(2));
  IncomingFrame other = frame(6);
  other.decode = [] {
    auto message = support::wall_frame(6);
    message.k[0] = 61;
    return ros::frame_from_message(message);
  };
  queue->push(std::move(other));
  ASSERT_TRUE(streamed.wait_for(3));
  EXPECT_EQ(gate.fused(), (std::vector<int>{1, 3, 1, 1}));
  EXPECT_EQ(statistics.counts().fusion_restarts, 1U);
  EXPECT_EQ(statistics.fusion_restart(), "camera.fx changed from 60 to 61");
}

TEST_F(SearchQueueTest, ABrokenFrameDoesNotCostThoseItIsCombinedWith) {
  SearchQueueOptions options;
  options.fuse_frames = options.frame_capacity = 3;
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  queue->push(frame(1));
  queue->push(bad_frame());
  gate.open();
  ASSERT_TRUE(streamed.wait_for(3));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(gate.fused(), (std::vector<int>{1, 2}));
  EXPECT_EQ(statistics.counts().frames_rejected, 1U);
}

TEST_F(SearchQueueTest, NextFrameRequestsWithoutAFrameTimeOut) {
  auto queue = make();
  ASSERT_TRUE(queue->push(job(false, milliseconds(30))).ok());
  ASSERT_TRUE(clock->wait_for_sleeper(milliseconds(30)));
  clock->advance(milliseconds(29));
  ASSERT_TRUE(clock->wait_for_sleeper(milliseconds(1)));
  EXPECT_EQ(answers.size(), 0U);
  clock->advance(milliseconds(1));
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(answers.code(0), StatusCode::timeout);
}

TEST_F(SearchQueueTest, ARequestWhoseTurnComesTooLateIsNotSearched) {
  auto queue = make();
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  ASSERT_TRUE(queue->push(job(true, milliseconds(30))).ok());
  clock->advance(milliseconds(30));
  gate.open();
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(answers.code(0), StatusCode::timeout);
  EXPECT_EQ(gate.stamps(), std::vector<std::int64_t>{0});
}

TEST_F(SearchQueueTest, OnDemandSearchesNothingUnasked) {
  SearchQueueOptions options;
  options.continuous = false;
  auto queue = make(options);
  gate.open();
  queue->push(frame(1));
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(gate.stamps(), std::vector<std::int64_t>{77});
  ASSERT_TRUE(queue->push(job(false)).ok());
  ASSERT_TRUE(answers.wait_for(2));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{77, 1}));
  EXPECT_EQ(streamed.size(), 0U);
}

TEST_F(SearchQueueTest, SurvivesADetectorThatThrows) {
  auto queue = make();
  gate.open();
  DetectJob bad = job(true);
  bad.request.seed = 666;
  ASSERT_TRUE(queue->push(std::move(bad)).ok());
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(answers.wait_for(2));
  EXPECT_EQ(answers.code(0), StatusCode::internal);
  EXPECT_EQ(answers.code(1), StatusCode::ok);
}

TEST_F(SearchQueueTest, WhatThrowsCostsItselfAlone) {
  auto queue = make();
  gate.open();
  IncomingFrame broken = frame(1);
  broken.decode = []() -> ros::DecodedFrame { throw std::bad_alloc(); };
  queue->push(std::move(broken));
  ASSERT_TRUE(streamed.wait_for(1));
  EXPECT_EQ(streamed.code(0), StatusCode::unavailable);
  EXPECT_EQ(statistics.counts().frames_rejected, 1U);

  DetectJob bomb = job(true);
  bomb.decode = []() -> ros::DecodedFrame { throw std::bad_alloc(); };
  ASSERT_TRUE(queue->push(std::move(bomb)).ok());
  ASSERT_TRUE(answers.wait_for(1));
  EXPECT_EQ(answers.code(0), StatusCode::unavailable);

  DetectJob narrow = job(false);
  narrow.restrict_frame = [](Frame&) -> Status { throw std::length_error("mask"); };
  ASSERT_TRUE(queue->push(std::move(narrow)).ok());
  ASSERT_TRUE(queue->push(job(false)).ok());
  queue->push(frame(2));
  ASSERT_TRUE(answers.wait_for(3));
  EXPECT_EQ(answers.code(1), StatusCode::internal);
  EXPECT_EQ(answers.code(2), StatusCode::ok);

  queue->run_later({}, {[] { throw std::runtime_error("no such folder"); }, {}});
  DetectJob rude = job(true);
  rude.done = [](auto&&...) { throw std::runtime_error("the client is gone"); };
  ASSERT_TRUE(queue->push(std::move(rude)).ok());
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(answers.wait_for(4));
  EXPECT_EQ(answers.code(3), StatusCode::ok);
}

TEST_F(SearchQueueTest, FramesOfSeveralCamerasDoNotDisplaceEachOther) {
  auto queue = make();
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  for (int stamp = 1; stamp <= 3; ++stamp) {
    queue->push(frame(stamp, "a"));
    queue->push(frame(10 + stamp, "b"));
  }
  gate.open();
  ASSERT_TRUE(streamed.wait_for(3));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 3, 13}));
  EXPECT_EQ(statistics.counts().frames_dropped, 4U);
}

// Where others search: several frames at once, but of one camera one after the other.
TEST_F(SearchQueueTest, SearchesAsManyFramesAtOnceAsThereMayBe) {
  auto queue = make({}, 3);
  queue->push(frame(0, "a"));
  ASSERT_TRUE(gate.wait_for_started(1));
  queue->push(frame(1, "a"));  // waits for the first of its camera
  queue->push(frame(2, "b"));
  ASSERT_TRUE(gate.wait_for_started(2));
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(gate.wait_for_started(3));
  ASSERT_TRUE(queue->push(job(true, milliseconds(5000), 1, 78)).ok());  // a fourth waits
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 2, 77}));
  EXPECT_EQ(queue->length(), 2U);
  gate.open();
  ASSERT_TRUE(streamed.wait_for(3));
  ASSERT_TRUE(answers.wait_for(2));
  EXPECT_EQ(statistics.counts().frames_processed, 3U);
  EXPECT_EQ(statistics.counts().requests_served, 2U);
}

TEST_F(SearchQueueTest, SeveralViewsAreNotCombinedWithFramesThatWait) {
  SearchQueueOptions options;
  options.fuse_frames = 3;
  options.camera = [](const std::string&, std::int64_t) { return Pose(); };
  auto queue = make(options);
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  IncomingFrame all;
  all.frame_id = "map";
  all.views.push_back(frame(1, "a"));
  all.views.push_back(frame(2, "b"));
  queue->push(std::move(all));
  queue->push(frame(3));
  gate.open();
  ASSERT_TRUE(streamed.wait_for(3));
  EXPECT_EQ(gate.stamps(), (std::vector<std::int64_t>{0, 3}));
  const Counts counts = statistics.counts();
  EXPECT_EQ(counts.frames_processed, 2U);
  EXPECT_EQ(counts.frames_failed, 2U);  // the stub searches no views
}

TEST_F(SearchQueueTest, LeavingToAnotherServerAnswersNothingButWhatRuns) {
  auto queue = make();
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(gate.wait_for_started(1));
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(queue->push(job(false)).ok());
  queue->leave_to_another();
  EXPECT_TRUE(queue->push(job(true)).ok());
  bool told = false;
  queue->run_later({}, {[&] { told = true; }, [&](const Status&) { told = true; }});
  gate.open();
  queue->stop();
  EXPECT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers.code(0), StatusCode::ok);
  EXPECT_FALSE(told);
}

TEST_F(SearchQueueTest, StoppingAnswersWhatWaits) {
  auto queue = make();
  queue->push(frame(0));
  ASSERT_TRUE(gate.wait_for_started(1));
  ASSERT_TRUE(queue->push(job(true)).ok());
  ASSERT_TRUE(queue->push(job(false)).ok());
  std::thread stopper([&] { queue->stop(); });
  gate.open();
  stopper.join();
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(queue->push(job(true)).code, StatusCode::unavailable);
}

}  // namespace
}  // namespace bpa::server
