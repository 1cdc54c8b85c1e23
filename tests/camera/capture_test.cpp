// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The capture thread and its watchdog with a device that behaves as badly as it is told to.
#include "camera/capture.hpp"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::camera {
namespace {

using std::chrono::milliseconds;

/// What the device does, set by the test.
struct Behaviour {
  std::atomic<bool> there{true};
  std::atomic<bool> frames{true};
  std::atomic<bool> lost{false};
  std::atomic<bool> ended{false};
  std::atomic<bool> hangs{false};
  std::atomic<bool> open_hangs{false};
  std::atomic<int> opened{0};
  std::atomic<int> recording{0};
};

void hang(const std::atomic<bool>& while_set) {
  while (while_set) std::this_thread::sleep_for(milliseconds(1));
}

class FakeDevice : public CameraDevice {
 public:
  explicit FakeDevice(std::shared_ptr<Behaviour> b) : b_(std::move(b)) { ++b_->opened; }
  const std::string& name() const override { return name_; }
  Result<DeviceOutput> next(milliseconds) override {
    hang(b_->hangs);
    std::this_thread::sleep_for(milliseconds(2));
    if (b_->lost) return Status(StatusCode::unavailable, "was pulled out");
    DeviceOutput output;
    output.ended = b_->ended;
    if (b_->frames && !output.ended) output.images.emplace();
    return output;
  }
  Status start_recording(const std::string&) override {
    b_->recording = 1;
    return {};
  }
  Result<RecordingSummary> stop_recording() override {
    b_->recording = 2;
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
    times.timeout = milliseconds(60);
    times.retry = milliseconds(10);
    capture = std::make_unique<Capture>(
        [b = behaviour]() -> Result<std::unique_ptr<CameraDevice>> {
          hang(b->open_hangs);
          if (!b->there) return Status(StatusCode::unavailable, "no device is there");
          return std::unique_ptr<CameraDevice>(std::make_unique<FakeDevice>(b));
        },
        times, [this](SensorImages&&) { ++images; }, std::move(ready),
        [this](LogLevel, std::string_view text) {
          const std::lock_guard<std::mutex> lock(mutex);
          lines.emplace_back(text);
        });
  }
  /// Waits until the status says so.
  bool wait_for(const std::string& text) {
    for (int i = 0; i < 2000; ++i) {
      if (capture->status().text.find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(milliseconds(2));
    }
    return false;
  }
  /// How many log lines hold the text.
  int said(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex);
    int count = 0;
    for (const std::string& line : lines) count += line.find(text) != std::string::npos ? 1 : 0;
    return count;
  }
  Result<RecordingSummary> wait_for_recording(
      const std::function<void(Capture::Recorded)>& request) {
    std::mutex m;
    std::condition_variable come;
    std::optional<Result<RecordingSummary>> result;
    request([&](const Result<RecordingSummary>& r) {
      const std::lock_guard<std::mutex> lock(m);
      result.emplace(r);
      come.notify_all();
    });
    std::unique_lock<std::mutex> lock(m);
    if (!come.wait_for(lock, milliseconds(5000), [&] { return result.has_value(); })) {
      ADD_FAILURE() << "no answer";
      std::abort();
    }
    return *result;
  }

  std::shared_ptr<Behaviour> behaviour = std::make_shared<Behaviour>();
  std::atomic<int> images{0};
  std::mutex mutex;
  std::vector<std::string> lines;
  std::unique_ptr<Capture> capture;
};

TEST_F(CaptureThread, HandsImagesOn) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  while (images < 5) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(capture->status().level, LogLevel::info);
  capture.reset();
  const int last = images;
  std::this_thread::sleep_for(milliseconds(20));
  EXPECT_EQ(images, last);
}

TEST_F(CaptureThread, ADeviceThatIsNotThereIsSaidOnceAndTakenUpWhenItComes) {
  behaviour->there = false;
  start();
  ASSERT_TRUE(wait_for("no device is there"));
  EXPECT_EQ(capture->status().level, LogLevel::error);
  std::this_thread::sleep_for(milliseconds(100));  // several attempts
  EXPECT_EQ(said("no device is there"), 1);
  behaviour->there = true;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADeviceThatIsPulledOutIsTakenUpAgain) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->there = false;
  behaviour->lost = true;
  ASSERT_TRUE(wait_for("was pulled out"));
  std::this_thread::sleep_for(milliseconds(60));
  EXPECT_TRUE(wait_for("was pulled out"));  // that it is not there is no news
  EXPECT_EQ(said("no device is there"), 0);
  EXPECT_EQ(capture->status().last_attempt, "no device is there");
  behaviour->lost = false;
  behaviour->there = true;
  ASSERT_TRUE(wait_for("images come from fake"));
  EXPECT_EQ(said("was pulled out"), 1);
  EXPECT_EQ(said("images come from fake"), 2);
  EXPECT_EQ(behaviour->opened, 2);
}

TEST_F(CaptureThread, ADeviceThatStopsDeliveringIsOpenedAgain) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->frames = false;
  ASSERT_TRUE(wait_for("delivers no frames any more"));
  while (behaviour->opened < 4) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(said("delivers no frames any more"), 1);
  behaviour->frames = true;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADriverThatHangsIsReportedAndBlocksNobody) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->hangs = true;
  ASSERT_TRUE(wait_for("does not return from waiting for a frame"));
  const auto refused = wait_for_recording(
      [&](auto done) { capture->start_recording("r.oni", milliseconds(1000), std::move(done)); });
  EXPECT_EQ(refused.status().code, StatusCode::unavailable);
  EXPECT_EQ(said("does not return"), 1);
  behaviour->hangs = false;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, ADriverThatHangsForEverIsLeftBehind) {
  behaviour->open_hangs = true;
  start();
  ASSERT_TRUE(wait_for("does not return from opening the device"));
  capture.reset();  // comes back after 2 s
  EXPECT_EQ(said("left behind"), 1);
  behaviour->open_hangs = false;  // what was left behind calls nobody any more
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_EQ(images, 0);
}

TEST_F(CaptureThread, TheEndOfARecordingIsNoError) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  behaviour->ended = true;
  ASSERT_TRUE(wait_for("come to its end"));
  EXPECT_EQ(capture->status().level, LogLevel::info);
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(behaviour->opened, 1);
}

TEST_F(CaptureThread, WaitsWhileTheSearchIsNotReady) {
  std::atomic<bool> ready{false};
  start([&ready] { return ready.load(); });
  std::this_thread::sleep_for(milliseconds(200));  // longer than the time-out
  EXPECT_EQ(images, 0);
  EXPECT_EQ(said("no frames"), 0);
  ready = true;
  ASSERT_TRUE(wait_for("images come from fake"));
}

TEST_F(CaptureThread, RecordsUntilItIsToldToStop) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  const auto begin = [&](int limit_ms) {
    return wait_for_recording([&, limit_ms](auto done) {
      capture->start_recording("none/r.oni", milliseconds(limit_ms), std::move(done));
    });
  };
  const auto end = [&] {
    return wait_for_recording([&](auto done) { capture->stop_recording(std::move(done)); });
  };
  EXPECT_EQ(end().status().code, StatusCode::not_found);
  ASSERT_TRUE(begin(100000).ok());
  EXPECT_EQ(capture->status().recording, "none/r.oni");
  EXPECT_EQ(begin(1000).status().code, StatusCode::busy);
  const auto summary = end();
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary->frames, 7U);
  EXPECT_EQ(capture->status().recording, "");
  // One that ends by itself can still be asked about.
  behaviour->recording = 0;
  ASSERT_TRUE(begin(20).ok());
  while (behaviour->recording != 2) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(end().ok());
  const test::TemporaryFolder folder;
  test::spill(folder / "there.oni", "x");
  const auto there = wait_for_recording([&](auto done) {
    capture->start_recording(folder / "there.oni", milliseconds(100), std::move(done));
  });
  EXPECT_EQ(there.status().code, StatusCode::invalid_argument);
}

TEST_F(CaptureThread, ADeviceThatIsLostEndsItsRecording) {
  start();
  ASSERT_TRUE(wait_for("images come from fake"));
  ASSERT_TRUE(wait_for_recording([&](auto done) {
                capture->start_recording("none/r.oni", milliseconds(100000), std::move(done));
              }).ok());
  behaviour->lost = true;
  ASSERT_TRUE(wait_for("was pulled out"));
  while (behaviour->recording != 2) std::this_thread::sleep_for(milliseconds(1));
}

}  // namespace
}  // namespace bpa::camera
