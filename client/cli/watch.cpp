// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <iostream>
#include <memory>

#include "client/cli/commands.hpp"
#include "client/cli/convert.hpp"
#include "client/cli/options.hpp"
#include "client/cli/output.hpp"

namespace bpa::cli {
namespace {

struct WatchOptions {
  bool json = false;
  bool table = false;
  std::string annotated;
  int top = 5;
  int count = 0;  ///< Results after which to stop; 0: never stop.
};

/// How many results came in each of the last seconds.
class Rate {
 public:
  double add() {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back(now);
    while (now - times_.front() > std::chrono::seconds(3)) times_.pop_front();
    const std::chrono::duration<double> span = now - times_.front();
    return times_.size() < 2 ? 0 : static_cast<double>(times_.size() - 1) / span.count();
  }

 private:
  std::deque<std::chrono::steady_clock::time_point> times_;
};

void watch(const Common& common, const WatchOptions& options) {
  std::atomic<int> seen{0};
  Rate rate;
  Client client = common.connect();
  or_throw(client.subscribe([&](const DetectionSet& set) {
    if (options.count > 0 && seen >= options.count) return;
    if (options.json) {
      std::puts(io::result_json_line(to_frame_result(set)).c_str());
      std::fflush(stdout);
    } else if (options.table) {
      print_table(set, rate.add());
    } else {
      print_detections(set, options.top);
    }
    ++seen;
  }));
  if (!options.annotated.empty()) {
    or_throw(client.subscribe_annotated([&](const AnnotatedImage& image) {
      const Status written = write_annotated(options.annotated, image);
      if (!written.ok()) std::cerr << "bpa-client: " << written.message << '\n';
    }));
  }
  wait_until([&] { return options.count > 0 && seen >= options.count; });
}

}  // namespace

void add_watch(CLI::App& program, const Common& common) {
  CLI::App* command =
      program.add_subcommand("watch", "print what the server finds until interrupted");
  auto options = std::make_shared<WatchOptions>();
  auto* json = command->add_flag("--json", options->json, "one line of JSON for each frame");
  command->add_flag("--table", options->table, "the last frame's objects as a table that stays")
      ->excludes(json);
  command->add_option("--annotated", options->annotated, "write annotated images to this folder");
  command->add_option("--top", options->top, "interpretations to print for each frame")
      ->capture_default_str();
  command->add_option("--count", options->count, "frames after which to stop; default never");
  command->callback([options, &common] { watch(common, *options); });
}

}  // namespace bpa::cli
