// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// tracks, rename, hold, forget: the objects that the server follows.
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>

#include "client/cli/commands.hpp"
#include "client/cli/convert.hpp"

namespace bpa::cli {
namespace {

struct TracksOptions {
  bool json = false;
  bool table = false;
  int count = 0;  ///< Frames after which to stop; 0: never stop.
};

void print_track(const TrackedObject& object) {
  const auto& p = object.frame_from_object.position;
  const auto& v = object.velocity;
  std::printf("%5llu %-24s %-9s %5.1f %%  %+7.3f %+7.3f %+7.3f  %5.2f m/s  seen %3.0f %%",
              static_cast<unsigned long long>(object.id), object.name.c_str(),
              to_string(object.state), 100 * object.probability, p[0], p[1], p[2],
              std::hypot(v[0], v[1], v[2]), 100 * object.visible_fraction);
  if (object.unseen_s > 0) std::printf("  unseen for %.1f s", object.unseen_s);
  if (object.held) std::printf("  held");
  if (!object.alternatives.empty()) {
    std::printf("  or %zu other poses", object.alternatives.size());
  }
  std::printf("\n");
}

void print_tracks(const TrackSet& set) {
  std::printf("frame %lld.%03lld  in %s  followed in %.1f ms\n",
              static_cast<long long>(set.stamp_ns / 1'000'000'000),
              static_cast<long long>(set.stamp_ns / 1'000'000 % 1000), set.frame_id.c_str(),
              set.total_ms);
  for (const TrackedObject& object : set.tracks) print_track(object);
  for (const EndedObject& ended : set.ended) {
    std::printf("%5llu %-24s ended: %s\n", static_cast<unsigned long long>(ended.id),
                ended.name.c_str(), ended.reason.c_str());
  }
}

void watch_tracks(const Common& common, const TracksOptions& options) {
  std::atomic<int> seen{0};
  Client client = common.connect();
  or_throw(client.tracks([&](const TrackSet& set) {
    if (options.count > 0 && seen >= options.count) return;
    if (options.json) {
      std::puts(io::track_json_line(to_track_result(set)).c_str());
    } else {
      if (options.table) std::printf("\x1b[H\x1b[J");  // home, and clear what follows
      print_tracks(set);
    }
    std::fflush(stdout);
    ++seen;
  }));
  wait_until([&] { return options.count > 0 && seen >= options.count; });
}

}  // namespace

void add_tracks(CLI::App& program, const Common& common) {
  CLI::App* command = program.add_subcommand(
      "tracks", "print the objects that the server follows until interrupted");
  const auto options = std::make_shared<TracksOptions>();
  auto* json = command->add_flag("--json", options->json, "one line of JSON for each frame");
  command->add_flag("--table", options->table, "the last frame's tracks as a table that stays")
      ->excludes(json);
  command->add_option("--count", options->count, "frames after which to stop; default never");
  command->callback([options, &common] { watch_tracks(common, *options); });

  const auto track = std::make_shared<std::string>(), name = std::make_shared<std::string>();
  const auto add_edit = [&](const char* word, const char* description) {
    CLI::App* edit = program.add_subcommand(word, description);
    edit->add_option("track", *track, "its name or its id")->required();
    return edit;
  };
  CLI::App* rename = add_edit("rename", "give a track another name");
  rename->add_option("name", *name, "the name that it gets")->required();
  rename->callback([=, &common] { or_throw(common.connect().rename_track(*track, *name)); });

  const auto release = std::make_shared<bool>(false);
  CLI::App* hold = add_edit("hold", "keep a track however long its object is not seen");
  hold->add_flag("--off", *release, "no longer");
  hold->callback([=, &common] { or_throw(common.connect().hold_track(*track, !*release)); });

  add_edit("forget", "end a track")->callback([=, &common] {
    or_throw(common.connect().forget_track(*track));
  });
}

}  // namespace bpa::cli
