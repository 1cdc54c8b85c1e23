// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <thread>

#include <nlohmann/json.hpp>

#include "client/cli/commands.hpp"
#include "client/cli/convert.hpp"
#include "client/cli/inbox.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"

// record and play. Two sources can be recorded, beside topics (--bag). The server's own sensor: the
// server records every frame as it left the driver, with nothing lost on the network; this program
// asks it to (--oni). And what clients publish to the server, with what it finds: that is taken
// down here (--to), and can be played:
//
//   FOLDER/test/000001/{rgb,depth}/NNNNNN.png, scene_camera.json
//                           BOP layout, for `bpa detect --bop`
//   FOLDER/recording.json   when each frame came, its stamp
//   FOLDER/results.json     as `bpa-client send --json`

namespace bpa::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using Seconds = std::chrono::duration<double>;

constexpr double kLongest = 3600;  // seconds, the server's limit
constexpr const char* kScene = "test/000001";
constexpr double kFloatUnit_mm = 0.1;

struct RecordOptions {
  std::string oni;
  std::string folder;
  BagOptions bag;
  double seconds = 0;  ///< 0: until interrupted.
};

struct PlayOptions {
  std::string folder;
  double speed = 1;
  double wait_s = 30;
  std::string json;
};

void print_recording_to(const std::string& path, const char* more) {
  std::printf("recording to %s%s\n", path.c_str(), more);
  std::fflush(stdout);
}

/// Until it is interrupted or so many seconds are over.
void wait(double seconds) {
  wait_until(
      [seconds, begun = Clock::now()] { return Seconds(Clock::now() - begun).count() >= seconds; });
}

void record_there(Client client, const RecordOptions& options) {
  const bool limited = options.seconds > 0;
  const double seconds = limited ? options.seconds : kLongest;
  const Recording begun = or_throw(client.start_recording(options.oni, seconds));
  print_recording_to(begun.path, limited ? "" : "; ends with Ctrl-C or after an hour");
  wait(seconds);
  const Recording recording = or_throw(client.stop_recording());
  std::printf("%d frames, %.1f MB in %s\n", recording.frames,
              1e-6 * static_cast<double>(recording.bytes), recording.path.c_str());
}

std::vector<std::uint16_t> depth_of(const FrameView& frame) {
  const int count = frame.width * frame.height;
  if (frame.depth_mm != nullptr) return {frame.depth_mm, frame.depth_mm + count};
  std::vector<std::uint16_t> depth;
  depth.reserve(count);
  for (int i = 0; i < count; ++i) {
    const double units = std::round(static_cast<double>(frame.depth_m[i]) * 1000 / kFloatUnit_mm);
    depth.push_back(units > 0 && units <= 65535 ? static_cast<std::uint16_t>(units)
                                                : std::uint16_t{0});
  }
  return depth;
}

void write_json(const fs::path& path, const Json& json) {
  or_throw(io::write_file(path, json.dump(1) + "\n"));
}

/// Takes down frames. add() is called by the SDK's thread.
class FrameRecorder {
 public:
  explicit FrameRecorder(fs::path folder) : folder_(std::move(folder)) {}

  /// Does nothing after a file could not be written.
  void add(const FrameView& frame) {
    if (!trouble_.ok()) return;
    const auto now = Clock::now();
    if (times_.empty()) first_ = now;
    trouble_ = write(frame, times_.size());
    if (!trouble_.ok()) return;
    times_.push_back({{"after_s", Seconds(now - first_).count()},
                      {"stamp_ns", frame.stamp_ns},
                      {"frame_id", frame.frame_id}});
  }

  /// Writes what is known at the end. recording.json comes last: all that it tells of is on the
  /// disk.
  void finish() const {
    write_json(folder_ / kScene / "scene_camera.json", cameras_);
    or_throw(io::sync_folder(folder_));
    write_json(folder_ / "recording.json",
               {{"format", "bpa recording"}, {"version", 1}, {"frames", times_}});
  }
  std::size_t count() const { return times_.size(); }
  /// The first file that could not be written.
  const Status& trouble() const { return trouble_; }

 private:
  Status write(const FrameView& frame, std::size_t number) {
    const std::string name = io::bop_number(static_cast<int>(number)) + ".png";
    const fs::path scene = folder_ / kScene;
    if (frame.rgb != nullptr) {
      const int bytes = 3 * frame.width * frame.height;
      const Status status = io::write_color_png(
          scene / "rgb" / name, {frame.width, frame.height, {frame.rgb, frame.rgb + bytes}});
      if (!status.ok()) return status;
    }
    cameras_[std::to_string(number)] = {
        {"cam_K", {frame.fx, 0, frame.cx, 0, frame.fy, frame.cy, 0, 0, 1}},
        {"depth_scale", frame.depth_mm != nullptr ? 1.0 : kFloatUnit_mm}};
    return io::write_gray_png(scene / "depth" / name, {frame.width, frame.height, depth_of(frame)});
  }

  const fs::path folder_;
  Status trouble_;
  Clock::time_point first_;
  Json times_ = Json::array(), cameras_ = Json::object();
};

void record_here(const Common& common, const RecordOptions& options) {
  const fs::path folder = options.folder;
  FrameRecorder frames(folder);
  Inbox<DetectionSet> results;
  {
    Client client = common.connect();
    std::error_code error;
    if (fs::exists(folder, error)) {
      throw Failure(invalid_argument(options.folder + ": is there already"));
    }
    or_throw(io::make_folder(folder / kScene / "depth"));
    or_throw(client.subscribe_frames([&](const FrameView& frame) { frames.add(frame); }));
    or_throw(client.subscribe([&](const DetectionSet& set) { results.add(set); }));
    print_recording_to(options.folder, "");
    wait(options.seconds > 0 ? options.seconds : std::numeric_limits<double>::infinity());
  }
  const std::vector<DetectionSet> sets = results.take_all();
  write_results(folder / "results.json", sets);
  frames.finish();
  std::printf("%zu frames and %zu results in %s\n", frames.count(), sets.size(),
              options.folder.c_str());
  or_throw(frames.trouble());
}

/// When a recorded frame came and what it was called.
struct RecordedFrame {
  double after_s = 0;  ///< Since the first one.
  std::int64_t stamp_ns = 0;
  std::string frame_id;
};

std::vector<RecordedFrame> read_recording(const std::string& folder) {
  const std::string path = fs::path(folder) / "recording.json";
  const std::string bytes = or_throw(io::read_file(path));
  try {
    const Json json = Json::parse(bytes);
    std::vector<RecordedFrame> frames;
    for (const Json& frame : json.at("frames")) {
      frames.push_back({frame.at("after_s"), frame.at("stamp_ns"), frame.at("frame_id")});
    }
    return frames;
  } catch (const std::exception& error) {
    throw Failure({StatusCode::corrupt, path + ": " + error.what()});
  }
}

void play(const Common& common, const PlayOptions& options) {
  Inbox<DetectionSet> answers;
  Client client = common.connect();
  const std::vector<RecordedFrame> times = read_recording(options.folder);
  const std::vector<io::BopFrame> entries = or_throw(io::read_bop_frames(options.folder, "test"));
  if (entries.size() != times.size()) {
    throw Failure({StatusCode::corrupt,
                   options.folder + ": recording.json tells of " + std::to_string(times.size()) +
                       " frames, but there are " + std::to_string(entries.size())});
  }
  or_throw(client.subscribe([&](const DetectionSet& set) { answers.add(set); }));
  Clock::time_point begun;
  double latest_s = 0;
  for (std::size_t i = 0; i < entries.size() && !interrupted(); ++i) {
    Frame frame = load_frame(entries[i], {}, times[i].stamp_ns);
    frame.frame_id = times[i].frame_id;
    if (i == 0) begun = Clock::now();
    const Seconds due(times[i].after_s / options.speed);
    std::this_thread::sleep_until(begun + std::chrono::duration_cast<Clock::duration>(due));
    latest_s = std::max(latest_s, (Clock::now() - begun - due).count());
    or_throw(client.publish_frame(view_of(frame)));
    if (i == 0) begun = Clock::now();  // the first one waits until the server listens
  }
  answers.wait(times.back().stamp_ns, options.wait_s);
  const std::vector<DetectionSet> sets = answers.take_all();
  std::printf("%zu frames played, at most %.0f ms late; %zu results\n", entries.size(),
              1000 * latest_s, sets.size());
  write_results(options.json, sets);
}

}  // namespace

void add_record(CLI::App& program, const Common& common) {
  CLI::App* command = program.add_subcommand(
      "record", "record frames, results and topics, or have the server record its camera");
  auto options = std::make_shared<RecordOptions>();
  auto* oni =
      command->add_option("--oni", options->oni,
                          "new OpenNI2 recording, below the server's capture.record_folder (about "
                          "46 MB a second)");
  auto* to = command->add_option(
      "--to", options->folder,
      "new folder for the results and the frames that clients publish: a BOP data set with times; "
      "32FC1 depth is rounded to 0.1 mm, at most 6.5 m");
  auto* bag = command->add_option(
      "--bag", options->bag.path,
      "new recording of ROS 2, FILE.mcap, of topics as they are published (bpa detect --bag)");
  command
      ->add_option("--topics", options->bag.topics,
                   "what --bag records; default: frames of clients, results, tracks, transforms")
      ->needs(bag)
      ->delimiter(',');
  command->add_option("--seconds", options->seconds, "how long; default until interrupted")
      ->check(CLI::Range(0.1, kLongest));
  command->callback([=, &common] {
    if (oni->count() + to->count() + bag->count() != 1) {
      throw CLI::ValidationError("record", "give one of --oni FILE, --to FOLDER, --bag FILE.mcap");
    }
    if (*bag) {
      options->bag.seconds = options->seconds;
      record_bag(common, options->bag);
    } else if (*oni) {
      record_there(common.connect(), *options);
    } else {
      record_here(common, *options);
    }
  });
}

void add_play(CLI::App& program, const Common& common) {
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
  command->callback([options, &common] { play(common, *options); });
}

}  // namespace bpa::cli
