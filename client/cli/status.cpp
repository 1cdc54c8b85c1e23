// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "client/cli/commands.hpp"

namespace bpa::cli {
namespace {

void print(const ServerStatus& s) {
  std::printf("bpa-server %s, %s for %.0f s, %.0f MB\n", s.version.c_str(), s.state.c_str(),
              s.uptime_s, 1e-6 * static_cast<double>(s.memory_bytes));
  std::printf("library   %s, %d models\n", s.library.c_str(), s.model_count);
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("frames    %llu received, %llu searched, %llu dropped, %llu rejected\n",
              count(s.frames_received), count(s.frames_processed), count(s.frames_dropped),
              count(s.frames_rejected));
  std::printf("requests  %llu served, %llu refused\n", count(s.requests_served),
              count(s.requests_refused));
  std::printf("queue     %d of %d\n", s.queue_length, s.queue_capacity);
  for (const StageTime& time : s.stage_times) {
    std::printf("  %-28s %8.1f ms (median)\n", time.stage.c_str(), time.milliseconds);
  }
  for (const auto& [key, value] : s.details) {
    std::printf("  %-38s %s\n", key.c_str(), value.c_str());
  }
}

}  // namespace

void add_status(CLI::App& program, Common& common) {
  program
      .add_subcommand("status",
                      "how the server is doing; with --timeout S, waits until it is there")
      ->callback([&common] {
        common.run([](Client client) {
          const auto status = client.status();
          if (status.ok()) print(*status);
          return status.status();
        });
      });
}

}  // namespace bpa::cli
