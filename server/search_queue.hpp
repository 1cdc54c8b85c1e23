// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame_fusion.hpp"
#include "idl/wire/endpoint.hpp"
#include "ros/frames.hpp"
#include "server/busy.hpp"
#include "server/fair_queue.hpp"
#include "server/once.hpp"
#include "server/options.hpp"
#include "server/recognition.hpp"
#include "server/statistics.hpp"

// Between DDS and the detector: DDS threads put frames and requests into bounded queues and go. A
// search thread takes them out, computes with no lock held and hands the results on. There are
// several where other hosts search (Recognition::searches_at_once()); frames of one camera are
// searched one after the other. An exception costs the frame or request that caused it: it is
// counted, answered and logged.

namespace bpa::server {

/// A frame as it came in. Turning it into a Frame is work, so a search thread does it.
struct IncomingFrame {
  Once<ros::DecodedFrame> decode;
  std::int64_t stamp_ns = 0;
  std::string frame_id;
  std::vector<PosePrior> priors = {};  ///< Of the sender, about its objects.
  std::function<void()> taken = {};    ///< Called when its search begins; may be empty.
  /// Frames of several cameras that are one search; then this is no frame itself, and frame_id is
  /// that of the results.
  std::vector<IncomingFrame> views = {};
};

/// One detect request that waits for its answer.
struct DetectJob {
  /// Makes the frame that the request carries; empty: search the next frame that comes in.
  Once<ros::DecodedFrame> decode;
  /// Narrows the next frame down (region, mask); may be empty.
  std::function<Status(Frame&)> restrict_frame;
  DetectRequest request;
  std::chrono::nanoseconds timeout{};  ///< No answer is wanted this long after push().
  wire::Guid client{};                 ///< Who asks; clients take turns.
  // Set by the queue when it accepts the job.
  std::size_t position = 0;  ///< Searches ahead of it.
  WaitableClock::TimePoint deadline{};
  /// Called once, then empty: with the answer, or with why there is none. `frame` is null when
  /// there is none.
  std::function<void(const DetectJob& job, const Frame* frame,
                     const Result<SceneInterpretations>& result)>
      done;
};

struct SearchQueueOptions {
  std::size_t frame_capacity = QueueOptions().frames;
  std::size_t request_capacity = QueueOptions().requests;
  bool continuous = DetectionOptions().continuous;
  int fuse_frames = DetectionOptions().fuse_frames;
  bool follow = DetectionOptions().follow;
  DetectRequest request;  ///< For every frame of the stream.
  /// Where a camera is in the frame of results; for frames with views.
  std::function<Result<Pose>(const std::string& frame_id, std::int64_t stamp_ns)> camera = {};
  /// Where objects are in the newest frame of this camera, from tracking. Nothing, or an empty
  /// function: what the camera's frame before showed.
  std::function<std::optional<std::vector<ExpectedPlacement>>(const std::string& frame_id)>
      expected = {};
  /// Whether objects are followed beside the search; an empty function: never.
  std::function<bool()> tracked = {};
  /// Then: receives what the search of a stream's frame has found after each round,
  std::function<void(const SceneInterpretations&)> on_round = {};
  int added_nice = 0;  ///< and this is added to the nice value of the searching threads.
};

class SearchQueue {
 public:
  /// `on_result` runs on a search thread for every frame of the stream, for one at a time; `frame`
  /// is null if illegal.
  using OnResult = std::function<void(const IncomingFrame& incoming, const Frame* frame,
                                      const Result<SceneInterpretations>& result)>;

  /// `clock` measures work; `ros_clock` frames' ages and requests' time-outs, null: `clock` does.
  SearchQueue(std::shared_ptr<const Recognition> recognition, const SearchQueueOptions& options,
              Statistics& statistics, OnResult on_result, LogHook log,
              std::shared_ptr<WaitableClock> clock = steady_clock(),
              std::shared_ptr<WaitableClock> ros_clock = nullptr);
  ~SearchQueue();
  SearchQueue(const SearchQueue&) = delete;
  SearchQueue& operator=(const SearchQueue&) = delete;

  /// Ends after the search that runs now; jobs that wait or come later are answered with
  /// `unavailable`. Not to be called from two threads at once.
  void stop();

  /// What each of its threads does now: a search, or a change of the library.
  std::vector<const Busy*> threads() const;
  /// Takes nothing more, and forgets what waits or comes later: another server answers it. stop()
  /// follows.
  void leave_to_another();
  /// For a search that hangs: answers what waits or comes later with `why`, and waits for nothing.
  void abandon(const Status& why);

  /// Never waits; the oldest frame of its camera goes when there are too many.
  void push(IncomingFrame frame);
  /// Accepts the job or refuses it: `busy` when the queue is full, `timeout` when, as searches go
  /// at present, its answer would come after its deadline. `done` is not called then. A full queue
  /// has room for a client with fewer jobs than another: the other's last one is refused.
  Status push(DetectJob job);

  /// For what comes from now on.
  void set_options(const SearchQueueOptions& options);

  /// Handles an errand (such as loading a model) between two searches, or refuses it as `busy`:
  /// a full queue has room as for jobs. What it throws is logged.
  void run_later(const wire::Guid& client, Errand errand);

  /// Frames and requests that wait.
  std::size_t length() const;

 private:
  /// A thread beside the first one.
  struct Helper {
    explicit Helper(std::shared_ptr<const WaitableClock> clock) : busy(std::move(clock)) {}

    Busy busy;
    std::thread thread;
  };

  void run();
  void help(Busy& busy);
  void call_helpers();
  std::deque<IncomingFrame>::iterator next_frame();
  void stop_taking(const Status& why);
  void refuse_waiting();
  Status admit(DetectJob job, std::optional<DetectJob>& displaced);
  std::optional<DetectJob> displace_for(const wire::Guid& client);
  bool has_work();
  double wait_ms(const DetectJob& job) const;
  std::vector<DetectJob> take_expired();
  Status guard(const char* about, const std::function<void()>& work);
  ros::DecodedFrame decoded(Once<ros::DecodedFrame> decode);
  void hand_over(DetectJob& job, const Frame* frame, const Result<SceneInterpretations>& result);
  void refuse(DetectJob& job, const Status& status);
  void refuse_failed(DetectJob& job, const Status& status);
  void answer(DetectJob& job, const Frame& frame, const DetectRequest& request);
  void run_one(std::unique_lock<std::mutex>& lock);
  void search_frames(std::unique_lock<std::mutex>& lock, const SearchQueueOptions& options,
                     Busy& busy);
  void search_request(std::unique_lock<std::mutex>& lock, Busy& busy);
  std::vector<IncomingFrame> take_frames(const SearchQueueOptions& options);
  bool combines_next(const IncomingFrame& first);
  void publish(const IncomingFrame& incoming, const Frame* frame,
               const Result<SceneInterpretations>& result);
  Frame fuse(Frame frame, const SearchQueueOptions& options);
  void work_on_frames(const SearchQueueOptions& options, std::vector<IncomingFrame> taken,
                      std::vector<DetectJob>& waiting);
  void work_on_views(const SearchQueueOptions& options, IncomingFrame incoming);
  Result<SceneInterpretations> search_views(const SearchQueueOptions& options,
                                            std::vector<IncomingFrame>& incoming);
  void keep_waiting(std::vector<DetectJob>& waiting);
  void note_restart(const std::string& reason);
  std::vector<ExpectedPlacement> expected_in(const SearchQueueOptions& options, const Frame& frame);
  void remember(const Frame& frame, const Result<SceneInterpretations>& result);
  void work_on_request(DetectJob& job);
  void answer_next_frame(const SearchQueueOptions& options, const IncomingFrame& incoming,
                         const Frame& frame, DetectJob& job,
                         const Result<SceneInterpretations>* shared);
  Result<SceneInterpretations> detect(const Frame& frame, const DetectRequest& request);
  Result<SceneInterpretations> searched(
      const std::function<Result<SceneInterpretations>()>& search);

  const std::shared_ptr<const Recognition> recognition_;
  Statistics& statistics_;
  const OnResult on_result_;
  const LogHook log_;
  const std::shared_ptr<WaitableClock> clock_;
  const std::shared_ptr<WaitableClock> ros_clock_;
  Busy busy_;
  int niceness_ = 0;  ///< What is added now; of the first thread alone.

  std::atomic<bool> noted_{false};  ///< The note of a frame was logged.
  std::mutex stream_mutex_;         ///< Guards the next three.
  FrameFusion fusion_;
  int last_fused_ = 1;  ///< How many frames the last one was made of.
  std::map<std::string, std::vector<ExpectedPlacement>> expected_;  ///< By frame_id.
  std::mutex publish_mutex_;                                        ///< Held while on_result_ runs.

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  SearchQueueOptions options_;
  /// At most options_.frame_capacity of each camera, of at most kMaxCameras in all.
  std::deque<IncomingFrame> frames_;
  std::set<std::string> in_search_;  ///< Cameras whose frames are searched now.
  std::size_t searching_ = 0;        ///< Threads that search now.
  std::size_t idle_helpers_ = 0;
  FairQueue<wire::Guid, DetectJob> requests_;  ///< With frames of their own.
  std::vector<DetectJob> awaiting_frame_;      ///< For the next frame.
  FairQueue<wire::Guid, Errand> errands_;
  bool frame_was_last_ = false;  ///< Whose turn it is when both wait.
  bool stopping_ = false;
  bool silent_ = false;  ///< Then: nobody is told.
  Status why_stopping_;
  std::deque<Helper> helpers_;
  std::thread thread_;  ///< Last: starts when all else is there.
};

}  // namespace bpa::server
