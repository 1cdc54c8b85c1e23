// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The capture thread and its watchdog with a device that behaves as badly as it is told to.
#include "camera/capture.hpp"

#include <atomic>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::camera {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRetry(1000);
// No multiple of kRetry: sleep_through() must not take the watchdog's sleep for the capture
// thread's.
constexpr milliseconds kTimeout(3500);
constexpr milliseconds kReadyPoll(2);  // of capture.cpp

/// Waits for a condition, for 20 s at most.
template <class Condition>
bool eventually(Condition condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

/// What the device does, set by the test.
struct Behaviour {
  std::atomic<bool> there{true};
  std::atomic<bool> frames{true};
  std::atomic<bool> lost{false};
  std::atomic<bool> ended{false};
  std::atomic<bool> hangs{false};
  std::atomic<bool> open_hangs{false};
  std::atomic<bool> hanging{false};
  std::atomic<int> attempts{0};  ///< To open it.
  std::atomic<int> opened{0};
  std::atomic<int> calls{0};  ///< Of next() that have returned.
  std::atomic<int> recordings_stopped{0};
  std::atomic<std::uint64_t> recorded_bytes{0};
  std::atomic<bool> disk_full{false};

  void hang(const std::atomic<bool>& while_set) {
    hanging = while_set.load();
    EXPECT_TRUE(eventually([&] { return !while_set; })) << "the test lets it hang";
    hanging = false;
  }
};

class FakeDevice : public CameraDevice {
 public:
  explicit FakeDevice(std::shared_ptr<Behaviour> b) : b_(std::move(b)) { ++b_->opened; }
  const std::string& name() const override { return name_; }
  Result<DeviceOutput> next(milliseconds) override {
    b_->hang(b_->hangs);
    std::this_thread::sleep_for(milliseconds(1));  // leave the processor to others
    ++b_->calls;
    if (b_->lost) return Status(StatusCode::unavailable, "was pulled out");
    DeviceOutput output;
    output.ended = b_->ended;
    if (b_->frames && !output.ended) output.images.emplace();
    return output;
  }
  Status start_recording(const std::string&) override { return {}; }
  Result<std::uint64_t> recorded_bytes() const override {
    if (b_->disk_full) return Status(StatusCode::unavailable, "the disk is full");
    return b_->recorded_bytes.load();
  }
  Result<RecordingSummary> stop_recording() override {
    ++b_->recordings_stopped;
    if (b_->disk_full) return Status(StatusCode::unavailable, "the disk is full");
    return RecordingSummary{"r.oni", 7, 70};
  }

 private:
  const std::shared_ptr<Behaviour> b_;
  const std::string name_ = "fake";
};

class CaptureThread : public ::testing::Test {
 protected:
  void start(std::function<bool()> ready = nullptr) {
    CaptureTimes times;
    times.timeout = kTimeout;
    times.retry = kRetry;
    capture = std::make_unique<Capture>(
        [b = behaviour]() -> Result<std::unique_ptr<CameraDevice>> {
          b->hang(b->open_hangs);
          ++b->attempts;
          if (!b->there) return Status(StatusCode::unavailable, "no device is there");
          return std::unique_ptr<CameraDevice>(std::make_unique<FakeDevice>(b));
        },
        times, [this](SensorImages&&) { ++images; }, std::move(ready),
        [this](LogLevel, std::string_view text) {
          const std::lock_guard<std::mutex> lock(mutex);
          lines.emplace_back(text);
        },
        clock);
  }
  /// Waits until the status says so.
  bool wait_for(const std::string& text) {
    return eventually([&] { return capture->status().text.find(text) != std::string::npos; });
  }
  /// Waits until the capture thread sleeps for a time, and lets the time pass.
  bool sleep_through(milliseconds time) {
    const bool asleep = clock->wait_for_sleeper(time);
    clock->advance(time);
    return asleep;
  }
  /// Lets time pass in steps that no call into the device spans two of.
  bool pass_while_it_is_asked(milliseconds time) {
    for (const milliseconds step : {time / 2, time - time / 2}) {
      const int before = behaviour->calls;
      if (!eventually([&] { return behaviour->calls >= before + 2; })) return false;
      clock->advance(step);
    }
    return true;
  }
  /// How many log lines hold the text.
  int said(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex);
    int count = 0;
    for (const std::string& line : lines) count += line.find(text) != std::string::npos ? 1 : 0;
    return count;
  }
  static Result<RecordingSummary> answer_to(const std::function<void(Capture::Recorded)>& request) {
    const auto promise = std::make_shared<std::promise<Result<RecordingSummary>>>();
    auto answer = promise->get_future();
    request([promise](const Result<RecordingSummary>& result) { promise->set_value(result); });
    if (answer.wait_for(std::chrono::seconds(20)) == std::future_status::ready) return answer.get();
    return Status(StatusCode::internal, "no answer");
  }
  Result<RecordingSummary> begin_recording(const std::string& path, milliseconds limit) {
    return begin_recording(path, RecordingLimits{limit});
  }
  Result<RecordingSummary> begin_recording(const std::string& path, const RecordingLimits& limits) {
    return answer_to([&](auto done) { capture->start_recording(path, limits, std::move(done)); });
  }
  Result<RecordingSummary> end_recording() {
    return answer_to([&](auto done) { capture->stop_recording(std::move(done)); });
  }

  std::shared_ptr<support::ManualClock> clock = std::make_shared<support::ManualClock>();
  std::shared_ptr<Behaviour> behaviour = std::make_shared<Behaviour>();
  std::atomic<int> images{0};
  std::mutex mutex;
  std::vector<std::string> lines;
  std::unique_ptr<Capture> capture;
};

TEST_F(CaptureThread, HandsImagesOn) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(eventually([&] { return images >= 5; }));
  EXPECT_EQ(capture->status().level, LogLevel::info);
  capture.reset();
  EXPECT_EQ(said("left behind"), 0);
  EXPECT_TRUE(eventually([&] { return behaviour.use_count() == 1; }));  // its thread has ended
}

TEST_F(CaptureThread, ADeviceThatIsNotThereIsSaidOnceAndTakenUpWhenItComes) {
  behaviour->there = false;
  start();
  for (int attempt = 0; attempt < 4; ++attempt) ASSERT_TRUE(sleep_through(kRetry));
  EXPECT_GE(behaviour->attempts, 4);
  EXPECT_EQ(capture->status().text, "no device is there");
  EXPECT_EQ(capture->status().level, LogLevel::error);
  EXPECT_EQ(said("no device is there"), 1);
  ASSERT_TRUE(clock->wait_for_sleeper(kRetry));
  behaviour->there = true;
  clock->advance(kRetry);
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADeviceThatIsPulledOutIsTakenUpAgain) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->there = false;
  behaviour->lost = true;
  for (int attempt = 0; attempt < 3; ++attempt) ASSERT_TRUE(sleep_through(kRetry));
  ASSERT_TRUE(clock->wait_for_sleeper(kRetry));
  EXPECT_GE(behaviour->attempts, 4);
  EXPECT_EQ(capture->status().text, "fake was pulled out");  // that it is not there is no news
  EXPECT_EQ(said("no device is there"), 0);
  EXPECT_EQ(capture->status().last_attempt, "no device is there");
  behaviour->lost = false;
  behaviour->there = true;
  clock->advance(kRetry);
  ASSERT_TRUE(wait_for("images come from fake"));
  EXPECT_EQ(said("was pulled out"), 1);
  EXPECT_EQ(said("images come from fake"), 2);
  EXPECT_EQ(behaviour->opened, 2);
}

TEST_F(CaptureThread, ADeviceThatStopsDeliveringIsOpenedAgain) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->frames = false;
  for (int opened = 1; opened < 4; ++opened) {
    ASSERT_TRUE(pass_while_it_is_asked(kTimeout + milliseconds(2)));
    ASSERT_TRUE(wait_for("delivers no frames any more"));
    ASSERT_TRUE(sleep_through(kRetry));
    ASSERT_TRUE(eventually([&] { return behaviour->opened == opened + 1; }));
  }
  EXPECT_EQ(said("delivers no frames any more"), 1);
  EXPECT_EQ(said("does not return"), 0);
  behaviour->frames = true;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADriverThatHangsIsReportedAndBlocksNobody) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->hangs = true;
  ASSERT_TRUE(eventually([&] { return behaviour->hanging.load(); }));
  clock->advance(kTimeout);
  ASSERT_TRUE(wait_for("does not return from waiting for a frame"));
  EXPECT_EQ(begin_recording("r.oni", kRetry).status().code, StatusCode::unavailable);
  EXPECT_EQ(said("does not return"), 1);
  behaviour->hangs = false;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADriverThatHangsForEverIsLeftBehind) {
  behaviour->open_hangs = true;
  start();
  ASSERT_TRUE(eventually([&] { return behaviour->hanging.load(); }));
  clock->advance(kTimeout);
  ASSERT_TRUE(wait_for("does not return from opening the device"));
  std::thread owner([&] { capture.reset(); });
  EXPECT_TRUE(sleep_through(milliseconds(2000)));  // its patience
  owner.join();
  EXPECT_EQ(said("left behind"), 1);
  behaviour->open_hangs = false;  // what was left behind calls nobody any more
  EXPECT_TRUE(eventually([&] { return behaviour.use_count() == 1; }));
  EXPECT_EQ(images, 0);
}

TEST_F(CaptureThread, TheEndOfARecordingIsNoError) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->ended = true;
  ASSERT_TRUE(wait_for("come to its end"));
  EXPECT_EQ(capture->status().level, LogLevel::info);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(sleep_through(kRetry));
  EXPECT_EQ(behaviour->attempts, 1);
}

TEST_F(CaptureThread, WaitsWhileTheSearchIsNotReady) {
  std::atomic<bool> ready{false};
  start([&ready] { return ready.load(); });
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(clock->wait_for_sleeper(kReadyPoll));
    clock->advance(2 * kTimeout);
  }
  ASSERT_TRUE(clock->wait_for_sleeper(kReadyPoll));
  EXPECT_EQ(behaviour->calls, 0);
  EXPECT_EQ(said("no frames"), 0);
  ready = true;
  clock->advance(kReadyPoll);
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, RecordsUntilItIsToldToStop) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  EXPECT_EQ(end_recording().status().code, StatusCode::not_found);
  ASSERT_TRUE(begin_recording("none/r.oni", kRetry).ok());
  EXPECT_EQ(capture->status().recording, "none/r.oni");
  EXPECT_EQ(begin_recording("none/r.oni", kRetry).status().code, StatusCode::busy);
  const auto summary = end_recording();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary->frames, 7U);
  EXPECT_EQ(capture->status().recording, "");
  EXPECT_EQ(behaviour->recordings_stopped, 1);
}

TEST_F(CaptureThread, ARecordingThatEndsByItselfCanStillBeAskedAbout) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(begin_recording("none/r.oni", kRetry).ok());
  clock->advance(kRetry);
  ASSERT_TRUE(eventually([&] { return behaviour->recordings_stopped == 1; }));
  EXPECT_TRUE(end_recording().ok());
  EXPECT_EQ(behaviour->recordings_stopped, 1);
}

TEST_F(CaptureThread, ARecordingEndsAtItsQuota) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(begin_recording("none/r.oni", RecordingLimits{kRetry, 1000}).ok());
  behaviour->recorded_bytes = 999;
  const int calls = behaviour->calls;
  ASSERT_TRUE(eventually([&] { return behaviour->calls > calls + 3; }));
  EXPECT_EQ(behaviour->recordings_stopped, 0);
  behaviour->recorded_bytes = 1000;
  ASSERT_TRUE(eventually([&] { return behaviour->recordings_stopped == 1; }));
  EXPECT_TRUE(end_recording().ok());
}

TEST_F(CaptureThread, AFullDiskEndsARecordingInItsError) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(begin_recording("none/r.oni", kRetry).ok());
  behaviour->disk_full = true;
  ASSERT_TRUE(eventually([&] { return behaviour->recordings_stopped == 1; }));
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(end_recording().status().message, "the disk is full");
  }
  behaviour->disk_full = false;
  EXPECT_TRUE(begin_recording("none/r.oni", kRetry).ok());
}

TEST_F(CaptureThread, RecordingsReplaceNoFile) {
  start();
  const test::TemporaryFolder folder;
  test::spill(folder / "there.oni", "x");
  EXPECT_EQ(begin_recording(folder / "there.oni", kRetry).status().code,
            StatusCode::invalid_argument);
}

TEST_F(CaptureThread, ADeviceThatIsLostEndsItsRecording) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(begin_recording("none/r.oni", kRetry).ok());
  behaviour->lost = true;
  ASSERT_TRUE(wait_for("was pulled out"));
  EXPECT_TRUE(eventually([&] { return behaviour->recordings_stopped == 1; }));
}

}  // namespace
}  // namespace bpa::camera
