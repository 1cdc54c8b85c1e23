// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "core/base/failure.hpp"
#include "core/io/bop_dataset.hpp"
#include "tests/soak/load.hpp"
#include "tests/soak/measures.hpp"
#include "tests/support/stub_server.hpp"

// bpa-soak FOLDER SECONDS: runs bpa-server with FOLDER/library under the load of load.hpp, with the
// frames of FOLDER/frames, and prints a table. Fails when counts do not add up or the server grows.
// FOLDER/server.log is what the server said.

namespace bpa::soak {
namespace {

// What may be between the median of the first quarter and that of the last.
constexpr double kMemoryGrowthMb = 48;   // heaps of the threads fill for some minutes
constexpr double kDescriptorGrowth = 8;  // killed clients not yet forgotten differ in number

using Clock = std::chrono::steady_clock;

bool failed = false;

void expect(bool good, const std::string& rule) {
  if (good) return;
  failed = true;
  std::printf("FAILED: %s\n", rule.c_str());
}

void row(const char* name, const std::string& values) {
  std::printf("%-12s %s\n", name, values.c_str());
}

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}
std::string number(std::uint64_t value) { return std::to_string(value); }

std::vector<Frame> load_frames(const std::string& folder) {
  std::vector<Frame> frames;
  for (const io::BopFrame& frame : or_throw(io::read_bop_frames(folder, "test"))) {
    frames.push_back(or_throw(io::load_bop_frame(frame)));
  }
  return frames;
}

/// What the server says of itself.
struct ServerCounts {
  explicit ServerCounts(const ServerStatus& from) : status(from) {
    const std::map<std::string, std::string> details(from.details.begin(), from.details.end());
    const auto value = [&](const char* key) { return std::stoull(details.at(key)); };
    failed = value("frames failed in the search");
    messages = value("messages of the camera") + value("messages malformed of the camera");
    lost = value("messages lost by DDS of the camera");
    to_follow = value("frames to follow received");
    followed = value("frames followed");
    for (const auto& [key, count] : details) {
      if (key.rfind("frames not followed: ", 0) == 0) not_followed += std::stoull(count);
    }
  }
  std::uint64_t frames_accounted() const {
    return status.frames_processed + status.frames_dropped + status.frames_rejected + failed;
  }

  ServerStatus status;
  std::uint64_t failed = 0, messages = 0, lost = 0;
  std::uint64_t to_follow = 0, followed = 0, not_followed = 0;
};

/// Waits until the server has worked off what came. A loss of DDS shows with the next message only,
/// so that some more frames may have to follow.
ServerCounts settled_counts(Client& client, CameraLoad& camera) {
  for (int attempt = 0;; ++attempt) {
    std::this_thread::sleep_for(milliseconds(200));
    const ServerCounts counts(or_throw(client.status()));
    const bool all_heard = counts.messages + counts.lost == camera.messages();
    const bool all_done = counts.frames_accounted() == counts.status.frames_received &&
                          counts.followed + counts.not_followed == counts.to_follow;
    if ((all_heard && all_done) || attempt == 50) return counts;
    if (!all_heard && attempt % 5 == 4) camera.publish();
  }
}

void report_frames(const ServerCounts& counts, const CameraLoad& camera) {
  const ServerStatus& status = counts.status;
  const std::uint64_t lost = camera.frames() - status.frames_received;
  row("frames", number(camera.frames()) + " = " + number(status.frames_processed) + " searched + " +
                    number(status.frames_dropped) + " dropped + " +
                    number(status.frames_rejected + counts.failed) + " rejected + " + number(lost) +
                    " lost");
  row("messages", number(camera.messages()) + " = " + number(counts.messages) + " received + " +
                      number(counts.lost) + " lost by DDS");
  expect(status.frames_processed > 0, "no frame was searched");
  expect(camera.frames() >= status.frames_received, "more frames came than were sent");
  expect(counts.frames_accounted() == status.frames_received,
         number(status.frames_received) + " frames received, " + number(counts.frames_accounted()) +
             " accounted for");
  expect(camera.messages() == 3 * camera.frames(), "the camera could not send every message");
  expect(camera.messages() == counts.messages + counts.lost, "messages do not add up");
  expect(lost <= counts.lost, "more frames lost than messages");
  expect(status.frames_rejected + counts.failed == 0, "frames were rejected");
}

void report_requests(const ServerCounts& counts, const RequestLoad& asker,
                     const KilledClients& killed) {
  row("requests", number(asker.asked) + " = " + number(asker.answered) + " answered + " +
                      number(asker.refused) + " refused + " + number(asker.timed_out) +
                      " timed out; " + number(asker.detections) + " objects found");
  for (const auto& [message, count] : asker.other) row("", number(count) + " x " + message);
  expect(asker.answered > 0, "no request was answered");
  expect(asker.asked == asker.answered + asker.refused + asker.timed_out, "requests do not add up");
  const std::uint64_t served = counts.status.requests_served;
  const std::uint64_t handled = served + counts.status.requests_refused;
  row("", "the server counts " + number(served) + " served, " +
              number(counts.status.requests_refused) + " refused, with those of " +
              number(killed.requests) + " killed clients");
  expect(served >= asker.answered, "the server served fewer requests than were answered");
  expect(handled <= asker.asked + killed.requests, "the server counts requests that none sent");
  const auto& times = asker.milliseconds_each;
  row("latency ms", text("%.0f median", percentile(times, 50)) +
                        text(", %.0f 95 %%", percentile(times, 95)) +
                        text(", %.0f 99 %%", percentile(times, 99)) +
                        text(", %.0f highest", percentile(times, 100)));
}

void report_tracks(const ServerCounts& counts, std::uint64_t sets) {
  row("tracks", number(counts.to_follow) + " frames = " + number(counts.followed) + " followed + " +
                    number(counts.not_followed) + " not followed; " + number(sets) +
                    " sets of tracks read");
  expect(counts.followed > 0 && sets > 0, "no frame was followed");
  expect(counts.to_follow == counts.followed + counts.not_followed, "tracks do not add up");
  expect(sets <= counts.followed, "more sets of tracks than frames followed");
}

/// `warm` to `end`: the seconds that count.
void report_growth(const std::vector<Reading>& readings, double warm, double end) {
  const double minute = std::min(60.0, (end - warm) / 4), quarter = (end - warm) / 4;
  const auto report = [&](const char* name, double Reading::*field) {
    const auto median = [&](double from, double to) {
      return percentile(during(readings, from, to, field), 50);
    };
    row(name, text("%.0f in the first ", median(warm, warm + minute)) +
                  text("%.0f s after warm-up, ", minute) +
                  text("%.0f in the last, ", median(end - minute, end)) +
                  text("%.0f highest", percentile(during(readings, 0, end, field), 100)));
    return median(end - quarter, end) - median(warm, warm + quarter);
  };
  const double memory = report("memory MB", &Reading::memory_mb);
  const double descriptors = report("descriptors", &Reading::descriptors);
  report("threads", &Reading::threads);
  expect(memory <= kMemoryGrowthMb,
         text("memory grew by %.1f MB", memory) + text("; at most %.0f", kMemoryGrowthMb));
  expect(descriptors <= kDescriptorGrowth,
         text("descriptors grew by %.0f", descriptors) + text("; at most %.0f", kDescriptorGrowth));
}

Client connected(std::chrono::seconds timeout = std::chrono::seconds(10)) {
  ClientOptions options = support::client_options();
  options.detect_timeout = timeout;
  return or_throw(Client::connect(options));
}

void soak(const std::string& folder, double seconds) {
  const std::vector<Frame> frames = load_frames(folder + "/frames");
  const std::string library = folder + "/library";
  const std::string model =
      std::filesystem::directory_iterator(library)->path().filename().string();
  support::Process server(
      {BPA_BINARY_DIR "/bin/bpa-server", "--localhost", "--library", library, "--namespace",
       support::test_namespace(), "--domain", std::to_string(support::test_domain()), "--set",
       "input.color=camera/color", "--set", "input.depth=camera/depth", "--set",
       "input.camera_info=camera/info"},
      folder + "/server.log");
  std::atomic<std::uint64_t> sets_of_tracks{0};
  Client watcher = connected();
  or_throw(watcher.tracks([&](const TrackSet&) { ++sets_of_tracks; }));
  RequestLoad asker(connected());
  ModelLoad loader(connected(std::chrono::seconds(60)));  // waits for the search that runs
  KilledClients killed;
  const auto reader = or_throw(SlowReader::create());
  const auto camera = or_throw(CameraLoad::create(frames));

  std::atomic<bool> stop{false};
  std::vector<std::thread> load;
  load.emplace_back([&] { camera->run(stop); });
  load.emplace_back([&] { asker.run(frames, stop); });
  load.emplace_back([&] { loader.run(model, stop); });
  load.emplace_back([&] { killed.run(stop); });
  std::vector<Reading> readings;
  const auto start = Clock::now();
  double now = 0;
  while (now < seconds && server.wait(milliseconds(0)) == -1) {
    readings.push_back(support::read_process(server.pid(), now));
    std::this_thread::sleep_for(milliseconds(500));
    now = std::chrono::duration<double>(Clock::now() - start).count();
  }
  stop = true;
  for (std::thread& thread : load) thread.join();
  if (server.pid() <= 0) {
    return expect(false, "the server ended; see " + folder + "/server.log");
  }

  const ServerCounts counts = settled_counts(watcher, *camera);
  report_frames(counts, *camera);
  report_requests(counts, asker, killed);
  report_tracks(counts, sets_of_tracks);
  report_growth(readings, std::min(60.0, now / 5), now);
  row("others", number(killed.killed) + " clients killed, " + number(loader.loads) +
                    " times a model loaded and unloaded, " + number(reader->read()) +
                    " detections read slowly");
  for (const auto& [message, count] : loader.failures) {
    expect(false, number(count) + " loads failed: " + message);
  }
  server.signal(SIGTERM);
  expect(server.wait(milliseconds(5000)) == 0, "the server did not end in good order");
}

}  // namespace
}  // namespace bpa::soak

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bpa-soak FOLDER SECONDS\n");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // the table is there even if the end hangs
  try {
    bpa::soak::soak(argv[1], std::atof(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bpa-soak: %s\n", error.what());
    return 1;
  }
  return bpa::soak::failed ? 1 : 0;
}
