// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "client/cli/commands.hpp"
#include "client/cli/recorder.hpp"

// Two sources can be recorded. The server's own sensor: the server records every frame as it left
// the driver, with nothing lost on the network; this program asks it to (--oni). And what clients
// publish to the server, with what it finds: that is taken down here (--to).

namespace bpa::cli {
namespace {

constexpr double kLongest = 3600;  // seconds, the server's limit

struct RecordOptions {
  std::string oni;
  std::string folder;
  double seconds = 0;  ///< 0: until interrupted.
};

Status record(Client& client, const RecordOptions& options) {
  const double seconds = options.seconds > 0 ? options.seconds : kLongest;
  const std::string path = std::filesystem::absolute(options.oni).lexically_normal().string();
  auto started = client.start_recording(path, seconds);
  if (!started.ok()) return started.status();
  std::printf("recording to %s%s\n", path.c_str(),
              options.seconds > 0 ? "" : "; ends with Ctrl-C or after an hour");
  std::fflush(stdout);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!interrupted() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  const auto recording = client.stop_recording();
  if (!recording.ok()) return recording.status();
  std::printf("%d frames, %.1f MB in %s\n", recording->frames,
              1e-6 * static_cast<double>(recording->bytes), recording->path.c_str());
  return {};
}

Status record_here(Client& client, const RecordOptions& options, Recorder& recorder) {
  if (Status status = recorder.start(client); !status.ok()) return status;
  std::printf("recording to %s\n", options.folder.c_str());
  std::fflush(stdout);
  const auto begun = std::chrono::steady_clock::now();
  const auto over = [&] {
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begun;
    return options.seconds > 0 && time.count() >= options.seconds;
  };
  while (!interrupted() && !over()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return recorder.finish();
}

}  // namespace

void add_record(CLI::App& program, Common& common) {
  CLI::App* command = program.add_subcommand(
      "record", "take down frames and results, or have the server record its camera");
  auto options = std::make_shared<RecordOptions>();
  auto* oni =
      command->add_option("--oni", options->oni,
                          "new OpenNI2 recording, on the server's machine (about 46 MB a second)");
  command
      ->add_option("--to", options->folder,
                   "new folder for the frames that clients publish, as a BOP data set with their "
                   "times, and for the results; 32FC1 depth is rounded to 0.1 mm, at most 6.5 m")
      ->excludes(oni);
  command->add_option("--seconds", options->seconds, "how long; default until interrupted")
      ->check(CLI::Range(0.1, kLongest));
  command->callback([options, &common] {
    if (options->oni.empty() == options->folder.empty()) {
      throw CLI::ValidationError("record", "give either --oni FILE or --to FOLDER");
    }
    common.run([&](Client client) {
      if (options->folder.empty()) return record(client, *options);
      Recorder recorder(options->folder);
      const Status status = record_here(client, *options, recorder);
      close(std::move(client));
      return status;
    });
  });
}

}  // namespace bpa::cli
