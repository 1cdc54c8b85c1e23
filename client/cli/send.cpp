// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>
#include <vector>

#include "client/cli/commands.hpp"
#include "client/cli/convert.hpp"
#include "client/cli/inbox.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"

// Sends frames one by one and waits for what the server finds in each (or sends them at a rate and
// takes what comes).

namespace bpa::cli {
namespace {

struct SendOptions {
  FrameFiles files;
  std::string json;       ///< File of `bpa detect --json`'s form; empty: none.
  std::string annotated;  ///< Folder of PNGs; empty: none.
  int top = 5;            ///< Interpretations to print a frame; 0 prints nothing.
  std::string priors;     ///< File; empty: none.
  double rate_hz = 0;     ///< 0: the next frame when the last one is answered.
  double wait_s = 120;
  int repeat = 1;
};

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// One run of the subcommand.
class Sender {
 public:
  Sender(const Common& common, const SendOptions& options)
      : options_(options), client_(common.connect()), priors_(read_priors(options.priors)) {}

  void run() {
    const std::vector<io::BopFrame> entries = list_frames(options_.files);
    or_throw(client_.subscribe([this](const DetectionSet& set) { answers_.add(set); }));
    if (!options_.annotated.empty()) {
      or_throw(
          client_.subscribe_annotated([this](const AnnotatedImage& image) { images_.add(image); }));
    }
    for (int round = 0; round < options_.repeat; ++round) {
      for (const io::BopFrame& entry : entries) {
        if (interrupted()) throw Failure({StatusCode::unavailable, "interrupted"});
        send(entry);
      }
    }
    if (options_.rate_hz > 0) {
      answers_.wait(sent_.back(), options_.wait_s);
      for (const std::int64_t stamp : sent_) collect(stamp, 0);
    }
    const int searched = static_cast<int>(results_.size()) - refused_;
    std::printf("%zu frames sent, %d searched, %d refused, %d without an answer\n", sent_.size(),
                searched, refused_, missing_);
    write_results(options_.json, results_);
    // At a rate, frames that a newer one displaced are no failure.
    if (refused_ == 0 && (missing_ == 0 || options_.rate_hz > 0)) return;
    throw Failure({StatusCode::unavailable,
                   std::to_string(refused_ + missing_) + " frames were not searched"});
  }

 private:
  void send(const io::BopFrame& entry) {
    const Frame frame = load_frame(entry, options_.files, now_ns());
    or_throw(client_.publish_frame(view_of(frame), priors_));
    sent_.push_back(frame.stamp_ns);
    if (options_.rate_hz > 0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(1 / options_.rate_hz));
    } else {
      collect(frame.stamp_ns, options_.wait_s);
    }
  }

  void collect(std::int64_t stamp_ns, double wait_s) {
    const auto set = answers_.take(stamp_ns, wait_s);
    if (!set) {
      ++missing_;
      return;
    }
    if (options_.top > 0) print_detections(*set, options_.top);
    results_.push_back(*set);
    if (!set->status.ok()) {
      ++refused_;
    } else if (!options_.annotated.empty()) {
      const auto image = images_.take(stamp_ns, 10);
      if (!image) {
        throw Failure({StatusCode::timeout, "the server sent no annotated image within 10 s"});
      }
      or_throw(write_annotated(options_.annotated, *image));
    }
  }

  const SendOptions& options_;
  Inbox<DetectionSet> answers_;
  Inbox<AnnotatedImage> images_;
  Client client_;                     // its callbacks use those above
  std::vector<ExpectedPose> priors_;  ///< Of each frame.
  std::vector<std::int64_t> sent_;
  std::vector<DetectionSet> results_;
  int missing_ = 0;
  int refused_ = 0;
};

}  // namespace

void add_send(CLI::App& program, const Common& common) {
  CLI::App* command = program.add_subcommand(
      "send", "publish frames from disk to the server's stream and print what it finds");
  auto options = std::make_shared<SendOptions>();
  add_frame_options(*command, options->files);
  command->add_option("--json", options->json, "write all results to this file");
  command->add_option("--annotated", options->annotated, "write annotated images to this folder");
  command->add_option("--top", options->top, "interpretations to print for each frame")
      ->capture_default_str();
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
    check_frame_options("send", options->files, true);
    Sender(common, *options).run();
  });
}

}  // namespace bpa::cli
