// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/tracking.hpp"

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <numeric>

#include <gtest/gtest.h>

#include "idl/wire/time.hpp"
#include "tests/support/stub_tracker.hpp"

// The thread that follows, with a tracker that looks at no pixel.

namespace bpa::server {
namespace {

using std::chrono::milliseconds;

Frame frame_at(std::int64_t stamp_ns, const std::string& frame_id) {
  Frame frame;
  frame.camera = {32, 24, 30, 30, 15.5, 11.5};
  frame.depth.assign(32 * 24, 0.8f);
  frame.stamp_ns = stamp_ns;
  frame.frame_id = frame_id;
  return frame;
}

SceneInterpretations found_at(std::int64_t stamp_ns, const Eigen::Vector3d& at) {
  SceneInterpretations found;
  found.stamp_ns = stamp_ns;
  Placement placement;
  placement.model = "mug";
  placement.probability = 0.9;
  placement.frame_from_object.translation = at;
  found.interpretations.push_back({1, 0, 1, {placement}});
  return found;
}

class TrackingThread : public testing::Test {
 protected:
  TrackingThread() { options_.queue_frames = 3; }

  void start() {
    auto tracker = std::make_unique<support::StubTracker>();
    tracker->changed = changed_;
    tracking_.emplace(std::move(tracker), options_,
                      TrackingLinks{[this] { return wanted_.load(); },
                                    [this](const TrackedFrame& frame) { take(frame); },
                                    [] { return std::int64_t{0}; },
                                    [this](LogLevel, std::string_view text) {
                                      const std::lock_guard<std::mutex> lock(mutex_);
                                      log_ += std::string(text) + '\n';
                                    }});
  }

  /// While this is held, the thread waits in the decoding of a frame.
  std::shared_ptr<SharedFrame> push(std::int64_t stamp_ns, const std::string& frame_id = "camera",
                                    std::shared_future<void> until = {}) {
    auto shared = std::make_shared<SharedFrame>([=] {
      if (until.valid()) until.wait();
      return ros::DecodedFrame(frame_at(stamp_ns, frame_id));
    });
    tracking_->push({shared, stamp_ns, frame_id, std::chrono::steady_clock::now()});
    return shared;
  }

  /// Waits until no frame waits; then all are accounted for.
  TrackingCounts settled() {
    TrackingCounts counts = tracking_->counts();
    for (int i = 0; i < 10000 && counts.waiting > 0; ++i) {
      std::this_thread::sleep_for(milliseconds(1));
      counts = tracking_->counts();
    }
    EXPECT_EQ(counts.received,
              std::accumulate(counts.unfollowed.begin(), counts.unfollowed.end(), counts.followed));
    return counts;
  }
  static std::uint64_t unfollowed(const TrackingCounts& counts, Unfollowed cause) {
    return counts.unfollowed[static_cast<std::size_t>(cause)];
  }

  void take(const TrackedFrame& frame) {
    const std::lock_guard<std::mutex> lock(mutex_);
    frames_.push_back(frame);
  }
  std::vector<TrackedFrame> frames() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return frames_;
  }
  std::string log() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return log_;
  }

  TrackingOptions options_;
  double changed_ = 1;  ///< What the tracker says of the scene.
  std::atomic<bool> wanted_{true};
  std::mutex mutex_;
  std::vector<TrackedFrame> frames_;
  std::string log_;
  std::optional<Tracking> tracking_;
};

TEST_F(TrackingThread, SceneThatStandsStillRestsOnceItIsSearched) {
  for (const auto& [changed, rest_s, rests] :
       {std::tuple(0.0, 60.0, true), {0.1, 60.0, false}, {0.0, 0.0, false}}) {
    changed_ = changed;
    options_.rest_s = rest_s;
    start();
    push(1);
    settled();
    EXPECT_FALSE(tracking_->rests()) << "it was not searched yet";
    tracking_->add(found_at(1, {0, 0, 0.7}));
    EXPECT_EQ(tracking_->rests(), rests);
    push(2);
    settled();
    EXPECT_EQ(tracking_->rests(), rests);
    push(3);
    settled();
    EXPECT_EQ(tracking_->rests(), rests);
  }
}

TEST_F(TrackingThread, FollowsFramesAndTakesResultsOfSearches) {
  start();
  push(1);
  settled();
  EXPECT_FALSE(tracking_->expected("camera")) << "nothing is there yet";
  tracking_->add(found_at(1, {0, 0, 0.7}));
  tracking_->add(found_at(77, {0, 0, 0.7}));  // of a frame that was not followed
  push(2);
  const TrackingCounts counts = settled();
  EXPECT_EQ(counts.followed, 2U);
  EXPECT_EQ(counts.untracked_searches, 1U);
  ASSERT_EQ(frames().size(), 2U);
  ASSERT_EQ(frames()[1].tracks.size(), 1U);
  EXPECT_EQ(frames()[1].tracks[0].name, "mug_1");
  ASSERT_TRUE(tracking_->expected("camera"));
  EXPECT_EQ(tracking_->expected("camera")->at(0).model, "mug");
  EXPECT_FALSE(tracking_->expected("another"));
}

TEST_F(TrackingThread, TheOldestOfTooManyFramesGoesUnlessTheSearchHasIt) {
  start();
  std::promise<void> go;
  const std::shared_future<void> gate = go.get_future().share();
  push(1, "camera", gate);
  while (tracking_->busy().work() == std::nullopt) std::this_thread::yield();
  push(2)->set_searched();
  for (int i = 3; i <= 6; ++i) push(i);
  go.set_value();
  const TrackingCounts counts = settled();
  EXPECT_EQ(counts.received, 6U);
  EXPECT_EQ(unfollowed(counts, Unfollowed::displaced), 2U);
  std::vector<std::int64_t> stamps;
  for (const TrackedFrame& frame : frames()) stamps.push_back(frame.stamp_ns);
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{1, 2, 5, 6}));
}

TEST_F(TrackingThread, EveryFrameIsCountedByWhatBecameOfIt) {
  start();
  push(10);
  push(10);               // the same stamp
  push(11, "elsewhere");  // another camera, while the first is there
  settled();
  auto broken = std::make_shared<SharedFrame>(
      [] { return ros::DecodedFrame(ros::RejectionCause::depth, invalid_argument("no depth")); });
  tracking_->push({broken, 12, "camera", std::chrono::steady_clock::now()});
  auto throwing = std::make_shared<SharedFrame>(
      []() -> ros::DecodedFrame { throw std::runtime_error("boom"); });
  tracking_->push({throwing, 13, "camera", std::chrono::steady_clock::now()});
  settled();
  wanted_ = false;
  options_.linger_s = 0;
  tracking_->set_options(options_);
  push(14);
  const TrackingCounts counts = settled();
  EXPECT_EQ(counts.followed, 1U);
  EXPECT_EQ(unfollowed(counts, Unfollowed::stale), 1U);
  EXPECT_EQ(unfollowed(counts, Unfollowed::other_camera), 1U);
  EXPECT_EQ(unfollowed(counts, Unfollowed::rejected), 2U);
  EXPECT_EQ(unfollowed(counts, Unfollowed::unwanted), 1U);
  EXPECT_NE(log().find("elsewhere sends frames, and camera is followed"), std::string::npos);
}

TEST_F(TrackingThread, GoesOnForAWhileAfterTheLastSubscriberLeft) {
  start();
  EXPECT_TRUE(tracking_->active());
  wanted_ = false;
  EXPECT_TRUE(tracking_->active()) << "one that restarts finds the same tracks";
  options_.enabled = false;
  tracking_->set_options(options_);
  EXPECT_FALSE(tracking_->active());
  wanted_ = true;
  EXPECT_FALSE(tracking_->active());
}

TEST_F(TrackingThread, StampsThatGoBackBeginAnew) {
  start();
  push(100'000'000'000);
  settled();
  tracking_->add(found_at(100'000'000'000, {0, 0, 0.7}));
  push(100'000'000'001);
  push(5);
  EXPECT_EQ(settled().followed, 3U);
  ASSERT_EQ(frames().size(), 3U);
  EXPECT_EQ(frames()[1].tracks.size(), 1U);
  EXPECT_TRUE(frames()[2].tracks.empty());
  ASSERT_EQ(frames()[2].ended.size(), 1U);
  EXPECT_EQ(frames()[2].ended[0].name, "mug_1");
}

TEST_F(TrackingThread, TracksAreNamedHeldAndForgotten) {
  start();
  push(1);
  settled();
  EXPECT_EQ(tracking_->forget("mug_1").status().code, StatusCode::not_found);
  tracking_->add(found_at(1, {0, 0, 0.7}));
  push(2);
  settled();
  for (const char* bad : {"", "17", "a b", "a/b", "mug\n"}) {
    EXPECT_EQ(tracking_->rename("mug_1", bad).status().code, StatusCode::invalid_argument) << bad;
  }
  EXPECT_EQ(tracking_->rename("mug_1", std::string(101, 'a')).status().code,
            StatusCode::invalid_argument);
  ASSERT_TRUE(tracking_->rename("mug_1", "mine").ok());
  const Status gone = tracking_->hold("mug_1", true).status();
  EXPECT_EQ(gone.code, StatusCode::not_found);
  EXPECT_NE(gone.message.find("mine (1)"), std::string::npos) << gone.message;
  const Result<std::uint64_t> held = tracking_->hold("mine", true);
  ASSERT_TRUE(held.ok());
  EXPECT_EQ(*held, 1U);
  push(3);
  settled();
  EXPECT_EQ(frames().back().tracks.at(0).name, "mine");
  EXPECT_TRUE(frames().back().tracks.at(0).held);
  EXPECT_TRUE(tracking_->forget("1").ok());  // by its id
  push(4);
  settled();
  EXPECT_TRUE(frames().back().tracks.empty());
  EXPECT_EQ(frames().back().ended.at(0).name, "mine");
}

TEST_F(TrackingThread, AFixedFrameNeedsTheCamerasTransform) {
  options_.fixed_frame = "map";
  options_.tf_wait_ms = 1;
  start();
  push(1);
  settled();
  EXPECT_EQ(unfollowed(settled(), Unfollowed::no_transform), 1U);
  EXPECT_EQ(tracking_->report().level, SourceReport::kWarn);
  push(2);
  settled();
  const std::string said = log();
  EXPECT_EQ(said.find("(no transform"), said.rfind("(no transform")) << "said once: " << said;
  wire::geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "map";
  transform.child_frame_id = "camera";
  transform.transform.translation = {0, 0, 2};
  transform.transform.rotation = {1, 0, 0, 0};  // looks down
  tracking_->transforms().add(transform, true);
  push(3);
  settled();
  tracking_->add(found_at(3, {0.1, 0.2, 0.7}));
  push(4);
  EXPECT_EQ(settled().followed, 2U);
  const TrackedFrame last = frames().back();
  EXPECT_EQ(last.frame_id, "map");
  EXPECT_EQ(last.camera_frame_id, "camera");
  EXPECT_TRUE(last.in_fixed_frame);
  const Eigen::Vector3d at = last.tracks.at(0).frame_from_object.translation;
  EXPECT_LT((at - Eigen::Vector3d(0.1, -0.2, 1.3)).norm(), 1e-12) << at.transpose();
  EXPECT_EQ(tracking_->rename("mug_1", "camera").status().code, StatusCode::invalid_argument);
  EXPECT_NE(log().find("followed again"), std::string::npos);
  EXPECT_EQ(tracking_->report().level, SourceReport::kOk);
}

TEST(Latencies, AreQuantilesOfTheLastThousand) {
  Latencies latencies;
  EXPECT_EQ(latencies.quantile(0.5), 0);
  for (int i = 0; i < 500; ++i) latencies.add(1e6);
  for (int i = 1000; i > 0; --i) latencies.add(i);
  EXPECT_EQ(latencies.quantile(0), 1);
  EXPECT_NEAR(latencies.quantile(0.5), 500, 1);
  EXPECT_NEAR(latencies.quantile(0.99), 990, 1);
  EXPECT_EQ(latencies.quantile(1), 1000);
}

}  // namespace
}  // namespace bpa::server
