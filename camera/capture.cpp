// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/capture.hpp"

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"

namespace bpa::camera {
namespace {

using TimePoint = WaitableClock::TimePoint;

constexpr auto kWait = std::chrono::milliseconds(100);  // less where the time-out is short
constexpr auto kReadyPoll = std::chrono::milliseconds(2);
/// A driver that works closes a device in less.
constexpr auto kPatienceAtEnd = std::chrono::seconds(2);

}  // namespace

class Capture::Impl {
 public:
  Impl(OpenCamera open, const CaptureTimes& times, std::function<void(SensorImages&&)> on_images,
       std::function<bool()> ready, LogHook hook, std::shared_ptr<WaitableClock> clock)
      : clock_(std::move(clock)),
        times_(times),
        log_(std::move(hook)),
        on_images_(std::move(on_images)),
        ready_(std::move(ready)),
        open_(std::move(open)) {}

  void run() {
    bool ended = false;
    while (!stopping() && !ended) {
      std::unique_ptr<CameraDevice> camera = open();
      if (camera) {
        const Status status = guarded("the camera failed", [&] { ended = stream(*camera); });
        if (!status.ok()) set_state(LogLevel::error, status.message);
        if (recording_) (void)end_recording(camera.get());
        note_call("closing the device");
        camera.reset();
        note_call(nullptr);
      }
      work_on_tasks(nullptr);
      if (!stopping() && !ended) sleep(times_.retry);
    }
    while (!stopping()) {
      sleep(times_.retry);
      work_on_tasks(nullptr);
    }
    note_call("shutting the driver down");
    open_ = nullptr;
    note_call(nullptr);
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
    wake_.notify_all();
  }

  void watch() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopping_) {
      const bool reported = hangs();
      if (reported) {
        const std::string text = hang_text();
        lock.unlock();
        set_state(LogLevel::error, text);
        refuse_tasks(unavailable(text));
        lock.lock();
      }
      // A call that has not begun yet hangs no earlier than this.
      const TimePoint since = call_ != nullptr && !reported ? call_began_ : clock_->now();
      if (!stopping_) clock_->wait_until(wake_, lock, since + times_.timeout);
    }
  }

  /// Waits kPatienceAtEnd for the capture thread's end; the owner's functions are not called after.
  void stop() {
    bool in_time = false;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      stopping_ = true;
      wake_.notify_all();
      const TimePoint until = clock_->now() + kPatienceAtEnd;
      while (!finished_ && clock_->now() < until) clock_->wait_until(wake_, lock, until);
      in_time = finished_;
    }
    {
      const std::lock_guard<std::mutex> lock(deliver_mutex_);
      on_images_ = nullptr;
      ready_ = nullptr;
    }
    refuse_tasks(unavailable("the server is stopping"));
    if (!in_time) {
      log(log_, LogLevel::error, "capture: the driver does not return; it is left behind");
    }
  }

  /// Something to do with the open camera, on the capture thread; nullptr when none is open.
  struct Task {
    std::function<Result<RecordingSummary>(CameraDevice*)> work;
    Recorded done;
  };
  void post(Task task) {
    std::unique_lock<std::mutex> lock(mutex_);
    Status refused;
    if (stopping_) refused = unavailable("the server is stopping");
    if (hangs()) refused = unavailable(hang_text());
    if (refused.ok()) tasks_.push_back(std::move(task));
    wake_.notify_all();
    lock.unlock();
    if (!refused.ok()) task.done(refused);
  }

  Result<RecordingSummary> begin_recording(CameraDevice* camera, const std::string& path,
                                           const RecordingLimits& limits) {
    if (camera == nullptr) {
      return unavailable("there is no camera to record: ", status().text);
    }
    if (recording_) {
      return Status(StatusCode::busy, status().recording + " is being recorded; stop that first");
    }
    std::error_code error;
    if (std::filesystem::exists(path, error)) {
      return invalid_argument(path + " is there already; recordings replace no file");
    }
    if (Status s = camera->start_recording(path); !s.ok()) return s;
    recording_ = Recording{clock_->now() + limits.time, limits.bytes};
    recorded_.reset();
    note_recording(path);
    log(log_, LogLevel::info, "capture: recording to " + path);
    return RecordingSummary{path, 0, 0};
  }

  Result<RecordingSummary> end_recording(CameraDevice* camera) {
    if (recording_ && camera != nullptr) {
      recording_.reset();
      recorded_ = camera->stop_recording();
      const std::string path = note_recording("");
      if (recorded_->ok()) {
        log(log_, LogLevel::info,
            concat("capture: recorded ", (*recorded_)->frames, " frames to ", (*recorded_)->path));
      } else {
        log(log_, LogLevel::error,
            "capture: recording to " + path + " failed: " + recorded_->status().message);
      }
    }
    if (!recorded_) return Status(StatusCode::not_found, "nothing is being recorded");
    return *recorded_;
  }

  CaptureStatus status() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return status_;
  }

 private:
  /// Names the call into the driver that begins, for the watchdog; nullptr: it has returned.
  void note_call(const char* name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    call_ = name;
    call_began_ = clock_->now();
  }

  /// Names the file that is written from now on; returns what was written before.
  std::string note_recording(const std::string& path) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(status_.recording, path);
  }

  std::unique_ptr<CameraDevice> open() {
    note_call("opening the device");
    Result<std::unique_ptr<CameraDevice>> camera = guarded("the camera cannot be opened", open_);
    note_call(nullptr);
    bool lost = false;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      status_.last_attempt = camera.status().message;
      lost = reported_ && status_.level == LogLevel::error;
      if (camera.ok()) {
        status_.device = (*camera)->name();
        ++status_.opened;
      }
    }
    if (camera.ok()) return std::move(camera).value();
    // A camera that is gone is not there: that was said when it went.
    if (!lost || camera.status().code != StatusCode::unavailable) {
      set_state(LogLevel::error, camera.status().message);
    }
    return nullptr;
  }

  /// Until the camera is lost or the server stops; true when a recording came to its end.
  bool stream(CameraDevice& camera) {
    auto last_frame = clock_->now();
    while (!stopping()) {
      work_on_tasks(&camera);
      if (recording_ && recording_is_over(camera)) (void)end_recording(&camera);
      bool wanted = true;
      {
        const std::lock_guard<std::mutex> lock(deliver_mutex_);
        if (ready_) wanted = ready_();
      }
      if (!wanted) {
        last_frame = clock_->now();
        sleep(kReadyPoll);
        continue;
      }
      note_call("waiting for a frame");
      Result<DeviceOutput> output = camera.next(std::min(kWait, times_.timeout / 2));
      note_call(nullptr);
      if (!output.ok()) {
        set_state(LogLevel::error, camera.name() + " " + output.status().message);
        return false;
      }
      if (output->ended) {
        set_state(LogLevel::info, camera.name() + " has come to its end");
        return true;
      }
      if (output->images) {
        last_frame = clock_->now();
        const std::string complaint = camera.complaint();
        set_state(complaint.empty() ? LogLevel::info : LogLevel::warning,
                  complaint.empty() ? "images come from " + camera.name()
                                    : camera.name() + ": " + complaint);
        deliver(*std::move(output->images));
      } else if (output->busy) {
        last_frame = clock_->now();
      } else if (clock_->now() - last_frame > times_.timeout) {
        set_state(LogLevel::error,
                  concat(camera.name(), " delivers no frames any more (none for ",
                         times_.timeout.count(), " ms); it is opened again until it does"));
        return false;
      }
    }
    return false;
  }

  bool recording_is_over(const CameraDevice& camera) const {
    const Result<std::uint64_t> bytes = camera.recorded_bytes();
    return clock_->now() >= recording_->until || !bytes.ok() || *bytes >= recording_->most_bytes;
  }

  void deliver(SensorImages&& images) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ++status_.frames;
    }
    const std::lock_guard<std::mutex> lock(deliver_mutex_);
    if (on_images_) on_images_(std::move(images));
  }

  void set_state(LogLevel level, const std::string& text) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (reported_ && status_.level == level && status_.text == text) return;
      reported_ = true;
      status_.level = level;
      status_.text = text;
      if (stopping_) return;
    }
    log(log_, level, "capture: " + text);
  }

  std::vector<Task> take_tasks() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(tasks_, {});
  }
  void work_on_tasks(CameraDevice* camera) {
    for (const Task& task : take_tasks()) {
      task.done(guarded("the recording failed", [&] { return task.work(camera); }));
    }
  }
  void refuse_tasks(const Status& status) {
    for (const Task& task : take_tasks()) task.done(status);
  }

  std::string hang_text() const {
    return concat("the driver does not return from ", call_, " (", times_.timeout.count(),
                  " ms so far)");
  }
  bool stopping() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stopping_;
  }
  /// Whether the call into the driver that runs now has taken too long; `mutex_` is held.
  bool hangs() const { return call_ != nullptr && clock_->now() - call_began_ >= times_.timeout; }
  /// Waits for a time, a task or the end.
  void sleep(std::chrono::milliseconds time) {
    const TimePoint until = clock_->now() + time;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopping_ && tasks_.empty() && clock_->now() < until) {
      clock_->wait_until(wake_, lock, until);
    }
  }

  const std::shared_ptr<WaitableClock> clock_;
  const CaptureTimes times_;
  const LogHook log_;

  std::mutex deliver_mutex_;  ///< Held while the owner's functions run; they may be taken away.
  std::function<void(SensorImages&&)> on_images_;
  std::function<bool()> ready_;

  // Of the capture thread alone.
  OpenCamera open_;
  struct Recording {
    TimePoint until;
    std::uint64_t most_bytes = 0;
  };
  std::optional<Recording> recording_;                ///< The one that is being made.
  std::optional<Result<RecordingSummary>> recorded_;  ///< What became of the last one.

  mutable std::mutex mutex_;  ///< Guards what follows.
  std::condition_variable wake_;
  bool stopping_ = false;
  bool finished_ = false;
  bool reported_ = false;       ///< Whether any state was logged yet.
  const char* call_ = nullptr;  ///< The call into the driver that runs now.
  TimePoint call_began_;
  CaptureStatus status_;
  std::vector<Task> tasks_;
};

Capture::Capture(OpenCamera open, const CaptureTimes& times,
                 std::function<void(SensorImages&&)> on_images, std::function<bool()> ready,
                 LogHook log, std::shared_ptr<WaitableClock> clock)
    : impl_(std::make_shared<Impl>(std::move(open), times, std::move(on_images), std::move(ready),
                                   std::move(log), std::move(clock))),
      watchdog_([impl = impl_.get()] { impl->watch(); }) {
  // Detached: a thread that hangs in a driver cannot be joined. stop() waits for one that does not.
  std::thread([impl = impl_] { impl->run(); }).detach();
}

Capture::~Capture() {
  impl_->stop();
  watchdog_.join();
}

CaptureStatus Capture::status() const { return impl_->status(); }

void Capture::start_recording(const std::string& path, const RecordingLimits& limits,
                              Recorded done) {
  impl_->post({[impl = impl_.get(), path, limits](CameraDevice* camera) {
                 return impl->begin_recording(camera, path, limits);
               },
               std::move(done)});
}

void Capture::stop_recording(Recorded done) {
  impl_->post({[impl = impl_.get()](CameraDevice* camera) { return impl->end_recording(camera); },
               std::move(done)});
}

}  // namespace bpa::camera
