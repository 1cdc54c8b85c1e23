// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "commands.hpp"

// The server owns the sensor, so the server records: every frame as it left the driver, with
// nothing lost on the network. This program asks it to.

namespace bpa::cli {
namespace {

constexpr double kLongest = 3600;  // seconds, the server's limit

struct RecordOptions {
  std::string oni;
  double seconds = 0;  ///< 0: until interrupted.
};

Result<Recording> record(Client& client, const RecordOptions& options) {
  const double seconds = options.seconds > 0 ? options.seconds : kLongest;
  const std::string path = std::filesystem::absolute(options.oni).lexically_normal().string();
  auto started = client.start_recording(path, seconds);
  if (!started.ok()) return started;
  std::printf("recording to %s%s\n", path.c_str(),
              options.seconds > 0 ? "" : "; ends with Ctrl-C or after an hour");
  std::fflush(stdout);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!interrupted() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return client.stop_recording();
}

}  // namespace

void add_record(CLI::App& program, Common& common) {
  CLI::App* command =
      program.add_subcommand("record", "have the server record its own camera to a file");
  auto options = std::make_shared<RecordOptions>();
  command
      ->add_option("--oni", options->oni,
                   "new OpenNI2 recording, on the server's machine (about 46 MB a second)")
      ->required();
  command->add_option("--seconds", options->seconds, "how long; default until interrupted")
      ->check(CLI::Range(0.1, kLongest));
  command->callback([options, &common] {
    auto client = common.connect();
    if (!client.ok()) return common.fail(client.status());
    const auto recording = record(*client, *options);
    if (!recording.ok()) return common.fail(recording.status());
    std::printf("%d frames, %.1f MB in %s\n", recording->frames,
                1e-6 * static_cast<double>(recording->bytes), recording->path.c_str());
  });
}

}  // namespace bpa::cli
