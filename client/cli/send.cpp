// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "client/cli/commands.hpp"
#include "client/cli/frame_view.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"

// Sends frames one by one and waits for what the server finds in each (or sends them at a rate and
// takes what comes).

namespace bpa::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct SendOptions {
  FrameFiles files;
  Restriction restriction;
  Sinks sinks;
  std::string priors;  ///< File; empty: none.
  double rate_hz = 0;  ///< 0: the next frame when the last one is answered.
  double wait_s = 120;
  int repeat = 1;
};

/// What the server published, by the stamps of the frames that were sent. Filled by the SDK's
/// thread.
class Inbox {
 public:
  void add(const DetectionSet& set) {
    const std::lock_guard<std::mutex> lock(mutex_);
    results_[set.stamp_ns] = set;
    changed_.notify_all();
  }
  void add(const AnnotatedImage& image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    images_[image.stamp_ns] = image;
    changed_.notify_all();
  }
  /// False when it did not come in time.
  bool wait_for_result(std::int64_t stamp_ns, double seconds) {
    return wait(results_, stamp_ns, seconds);
  }
  bool wait_for_image(std::int64_t stamp_ns, double seconds) {
    return wait(images_, stamp_ns, seconds);
  }
  /// Takes them out.
  DetectionSet take_result(std::int64_t stamp_ns) { return take(results_, stamp_ns); }
  AnnotatedImage take_image(std::int64_t stamp_ns) { return take(images_, stamp_ns); }

 private:
  template <class T>
  bool wait(const std::map<std::int64_t, T>& items, std::int64_t stamp_ns, double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (items.count(stamp_ns) == 0) {
      if (interrupted() || Clock::now() >= end) return false;
      changed_.wait_for(lock, std::chrono::milliseconds(200));
    }
    return true;
  }
  template <class T>
  T take(std::map<std::int64_t, T>& items, std::int64_t stamp_ns) {
    const std::lock_guard<std::mutex> lock(mutex_);
    T item = std::move(items[stamp_ns]);
    items.erase(stamp_ns);
    return item;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::int64_t, DetectionSet> results_;
  std::map<std::int64_t, AnnotatedImage> images_;
};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// One run of the subcommand.
class Sender {
 public:
  Sender(Client client, const SendOptions& options)
      : options_(options), client_(std::move(client)) {}

  Status run();

 private:
  Status subscribe();
  Status send(const io::BopFrame& entry);
  Status collect(std::int64_t stamp_ns);

  const SendOptions& options_;
  std::vector<ExpectedPose> priors_;  ///< Of each frame.
  Inbox inbox_;
  std::vector<std::int64_t> sent_;
  std::vector<DetectionSet> results_;
  int missing_ = 0;
  int refused_ = 0;
  Client client_;  // the last one: its callbacks use the others
};

Status Sender::subscribe() {
  Status status = client_.subscribe([this](const DetectionSet& set) { inbox_.add(set); });
  if (!status.ok() || options_.sinks.annotated.empty()) return status;
  return client_.subscribe_annotated([this](const AnnotatedImage& image) { inbox_.add(image); });
}

Status Sender::send(const io::BopFrame& entry) {
  const auto frame = load_frame(entry, options_.restriction, now_ns());
  if (!frame.ok()) return frame.status();
  Status status = client_.publish_frame(view_of(*frame), priors_);
  if (!status.ok()) return status;
  sent_.push_back(frame->stamp_ns);
  if (options_.rate_hz > 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(1 / options_.rate_hz));
    return {};
  }
  return collect(frame->stamp_ns);
}

Status Sender::collect(std::int64_t stamp_ns) {
  const double wait_s = options_.rate_hz > 0 ? 2 : options_.wait_s;
  if (!inbox_.wait_for_result(stamp_ns, wait_s)) {
    ++missing_;
    return {};
  }
  DetectionSet set = inbox_.take_result(stamp_ns);
  if (options_.sinks.top > 0) print_detections(std::cout, set, options_.sinks.top);
  std::cout.flush();
  const bool searched = set.status.ok();
  if (!searched) ++refused_;
  results_.push_back(std::move(set));
  if (!searched || options_.sinks.annotated.empty()) return {};
  if (!inbox_.wait_for_image(stamp_ns, 10)) {
    return Status(StatusCode::timeout, "the server sent no annotated image within 10 s");
  }
  return write_annotated(options_.sinks.annotated, inbox_.take_image(stamp_ns));
}

Status Sender::run() {
  auto priors = read_priors(options_.priors);
  if (!priors.ok()) return priors.status();
  priors_ = std::move(priors).value();
  const auto entries = list_frames(options_.files);
  if (!entries.ok()) return entries.status();
  if (Status status = subscribe(); !status.ok()) return status;
  for (int round = 0; round < options_.repeat; ++round) {
    for (const io::BopFrame& entry : *entries) {
      if (interrupted()) return Status(StatusCode::unavailable, "interrupted");
      if (Status status = send(entry); !status.ok()) return status;
    }
  }
  if (options_.rate_hz > 0) {
    inbox_.wait_for_result(sent_.back(), options_.wait_s);
    for (const std::int64_t stamp : sent_) {
      if (inbox_.wait_for_result(stamp, 0)) {
        if (Status status = collect(stamp); !status.ok()) return status;
      } else {
        ++missing_;
      }
    }
  }
  std::cout << sent_.size() << " frames sent, "
            << results_.size() - static_cast<std::size_t>(refused_) << " searched, " << refused_
            << " refused, " << missing_ << " without an answer\n";
  if (Status s = write_results(options_.sinks.json, results_); !s.ok()) return s;
  // At a rate, frames that a newer one displaced are no failure.
  if (refused_ == 0 && (missing_ == 0 || options_.rate_hz > 0)) return {};
  return Status(StatusCode::unavailable,
                std::to_string(refused_ + missing_) + " frames were not searched");
}

}  // namespace

void add_send(CLI::App& program, Common& common) {
  CLI::App* command = program.add_subcommand(
      "send", "publish frames from disk to the server's stream and print what it finds");
  auto options = std::make_shared<SendOptions>();
  add_frame_options(*command, options->files);
  add_restriction_options(*command, options->restriction);
  add_sink_options(*command, options->sinks);
  command
      ->add_option("--rate", options->rate_hz,
                   "frames a second; default: each one when the last is answered")
      ->check(CLI::PositiveNumber);
  add_priors_option(*command, options->priors);
  command->add_option("--wait", options->wait_s, "seconds to wait for the answer to a frame")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--repeat", options->repeat, "how often to send all frames; default 1")
      ->check(CLI::PositiveNumber);
  command->callback([options, &common] {
    const Status status = check_frame_options(options->files, true);
    if (!status.ok()) throw CLI::ValidationError("send", status.message);
    common.run([&](Client client) { return Sender(std::move(client), *options).run(); });
  });
}

}  // namespace bpa::cli
