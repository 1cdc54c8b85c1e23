// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>
#include <thread>

#include "client/cli/commands.hpp"
#include "client/cli/frame_view.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"
#include "client/cli/recorder.hpp"

namespace bpa::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct PlayOptions {
  std::string folder;
  double speed = 1;
  double wait_s = 30;
  std::string json;
};

/// What comes back while the recording plays.
class Answers {
 public:
  void add(const DetectionSet& set) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sets_.push_back(set);
  }
  bool has(std::int64_t stamp_ns) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const DetectionSet& set : sets_) {
      if (set.stamp_ns == stamp_ns) return true;
    }
    return false;
  }
  std::vector<DetectionSet> sets() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return sets_;
  }

 private:
  std::mutex mutex_;
  std::vector<DetectionSet> sets_;
};

Status play(Client& client, const PlayOptions& options, Answers& answers) {
  const auto times = read_recording(options.folder);
  if (!times.ok()) return times.status();
  const auto entries = io::read_bop_frames(options.folder, "test");
  if (!entries.ok()) return entries.status();
  if (entries->size() != times->size()) {
    return Status(StatusCode::corrupt,
                  options.folder + ": recording.json tells of " + std::to_string(times->size()) +
                      " frames, but there are " + std::to_string(entries->size()));
  }
  Status status = client.subscribe([&answers](const DetectionSet& set) { answers.add(set); });
  if (!status.ok()) return status;
  Clock::time_point begun;
  double latest_s = 0;
  for (std::size_t i = 0; i < entries->size() && !interrupted(); ++i) {
    const RecordedFrame& recorded = (*times)[i];
    auto frame = load_frame((*entries)[i], {}, recorded.stamp_ns);
    if (!frame.ok()) return frame.status();
    frame->frame_id = recorded.frame_id;
    if (i == 0) begun = Clock::now();
    const std::chrono::duration<double> due(recorded.after_s / options.speed);
    std::this_thread::sleep_until(begun + std::chrono::duration_cast<Clock::duration>(due));
    const std::chrono::duration<double> late = Clock::now() - begun - due;
    latest_s = std::max(latest_s, late.count());
    if (status = client.publish_frame(view_of(*frame)); !status.ok()) return status;
    if (i == 0) begun = Clock::now();  // the first one waits until the server listens
  }
  const auto end = Clock::now() + std::chrono::duration<double>(options.wait_s);
  while (!interrupted() && Clock::now() < end && !answers.has(times->back().stamp_ns)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::printf("%zu frames played, at most %.0f ms late; %zu results\n", entries->size(),
              1000 * latest_s, answers.sets().size());
  return write_results(options.json, answers.sets());
}

}  // namespace

void add_play(CLI::App& program, Common& common) {
  CLI::App* command = program.add_subcommand(
      "play", "publish the frames of a recording (record --to) at the times at which they came");
  auto options = std::make_shared<PlayOptions>();
  command->add_option("folder", options->folder, "folder of the recording")->required();
  command->add_option("--speed", options->speed, "2 plays twice as fast")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command->add_option("--wait", options->wait_s, "seconds to wait for the last frame's result")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--json", options->json, "write the results to this file");
  command->callback([options, &common] {
    common.run([&](Client client) {
      Answers answers;
      const Status status = play(client, *options, answers);
      close(std::move(client));
      return status;
    });
  });
}

}  // namespace bpa::cli
