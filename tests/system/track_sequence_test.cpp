// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "client/cli/convert.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/io/bop_dataset.hpp"
#include "tests/support/latest.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"

// Tracks that a real server publishes of a simulated sequence, against the truth of its frames.

namespace bpa {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kObjects = 2;

/// Of a camera that moves before two objects, and the library of their models.
struct SimulatedSequence {
  const std::string folder = support::scratch_folder() + "/sequence";
  const std::string library = support::scratch_folder() + "/library";
  std::vector<io::BopFrame> frames;

  SimulatedSequence() {
    const std::string bpa = BPA_BINARY_DIR "/bin/bpa", log = folder + ".log";
    std::istringstream words(
        "simulate sequence --seed 3 --kind moving_camera --seconds 2 --rate 10 --drop 0 "
        "--camera-speed 0.5 --camera-turn-deg 60 --distractors 0 --objects 2,2 "
        "--models mug,cereal_box --out");
    std::vector<std::string> simulate = {bpa};
    simulate.insert(simulate.end(), std::istream_iterator<std::string>(words), {});
    simulate.push_back(folder);
    EXPECT_EQ(support::run(simulate, log, seconds(120)), 0) << support::read_text(log);
    EXPECT_EQ(
        support::run({bpa, "model", "from-bop", folder, "--library", library}, log, seconds(120)),
        0)
        << support::read_text(log);
    auto read = io::read_bop_frames(folder, "test");
    EXPECT_TRUE(read.ok()) << read.status().message;
    if (read.ok()) frames = std::move(read).value();
  }
};

bool all_confirmed(const TrackSet& set) {
  return set.tracks.size() == kObjects &&
         std::ranges::all_of(set.tracks, [](const TrackedObject& track) {
           return track.state == TrackedState::confirmed;
         });
}

TEST(TracksOfASequence, AreWhereTheObjectsAreAndKeepTheirIds) {
  const SimulatedSequence sequence;
  ASSERT_EQ(sequence.frames.size(), 20U);
  const std::string log = support::scratch_folder() + "/server.log";
  const support::Process server(support::own_command("bpa-server", {"--library", sequence.library}),
                                log);
  support::Latest<TrackSet> sets;
  auto client = Client::connect(support::client_options());  // calls back until it is destroyed
  ASSERT_TRUE(client.ok()) << client.status().message << support::read_text(log);
  ASSERT_TRUE(client->tracks([&sets](const TrackSet& set) { sets.add(set); }).ok());

  std::int64_t stamp_ns = 0;
  const auto tracks_of = [&](const io::BopFrame& entry) -> std::optional<TrackSet> {
    auto frame = io::load_bop_frame(entry);
    if (!frame.ok()) return std::nullopt;
    frame->frame_id = "camera";
    frame->stamp_ns = stamp_ns += 100'000'000;
    if (!client->publish_frame(cli::view_of(*frame)).ok()) return std::nullopt;
    return sets.wait_for([&](const TrackSet& set) { return set.stamp_ns == stamp_ns; });
  };
  // The first frame, at the rate of its stamps, until a search has found all: results whose frame
  // is 10 s older come too late.
  std::optional<TrackSet> set;
  const auto end = std::chrono::steady_clock::now() + seconds(120);
  do {
    std::this_thread::sleep_for(milliseconds(100));
    set = tracks_of(sequence.frames.front());
    ASSERT_TRUE(set.has_value()) << support::read_text(log);
  } while (!all_confirmed(*set) && std::chrono::steady_clock::now() < end);
  ASSERT_TRUE(all_confirmed(*set)) << support::read_text(log);
  std::map<int, std::uint64_t> ids;
  for (const TrackedObject& track : set->tracks) ids[track.model_number] = track.id;

  double moved = 0;
  for (const io::BopFrame& entry : sequence.frames) {
    set = tracks_of(entry);
    ASSERT_TRUE(set.has_value() && all_confirmed(*set)) << entry.im_id << support::read_text(log);
    for (const TrackedObject& track : set->tracks) {
      EXPECT_EQ(track.id, ids[track.model_number]);
      const auto truth =
          std::ranges::find(entry.truth, track.model_number, &io::BopInstance::obj_id);
      ASSERT_NE(truth, entry.truth.end()) << track.name;
      const auto& at = track.frame_from_object.position;
      const Eigen::Vector3d position(at[0], at[1], at[2]);
      EXPECT_LT((position - truth->camera_from_object.translation).norm(), kPoseTolerance_m)
          << track.name << " in frame " << entry.im_id;
      const auto& first = sequence.frames.front().truth;
      const auto begin = std::ranges::find(first, track.model_number, &io::BopInstance::obj_id);
      moved = std::max(
          moved,
          (truth->camera_from_object.translation - begin->camera_from_object.translation).norm());
    }
  }
  EXPECT_GT(moved, 0.05) << "the camera hardly moves";
}

}  // namespace
}  // namespace bpa
