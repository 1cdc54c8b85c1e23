// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Recordings of OpenNI2 and of ROS 2.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "camera/oni_file.hpp"
#include "ros/bag_frames.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/wall_bag.hpp"

namespace bpa::fuzz {
namespace {

void run_recording(std::string_view bytes) {
  const auto info = camera::inspect_oni_file(file_of(bytes, "a.oni"));
  if (!info.ok()) return;
  require(info->find(camera::OniStreamInfo::Kind::depth) != nullptr, "a recording has depth");
}

std::vector<std::string> recording_seeds() {
  using Kind = camera::OniStreamInfo::Kind;
  const std::string path = file_of("", "seed.oni");
  const camera::OniStreamFormat depth{Kind::depth, 4, 2, 30, 100, 16, 10000, 1.0, 0.8, false, 2.5};
  const camera::OniStreamFormat color{Kind::color, 4, 2, 30, 200, 24, 0, 1.0, 0.8, false, 0};
  auto writer = camera::OniWriter::create(path, {depth, color}, true);
  require(writer.ok(), "a seed can be written");
  const std::vector<char> pixels(24, 9);
  (void)writer->add(0, 5000, pixels.data(), 16);
  (void)writer->add(1, 5000, pixels.data(), 24);
  (void)writer->finish();
  std::ifstream file(path, std::ios::binary);
  return {std::string(std::istreambuf_iterator<char>(file), {})};
}

void run_bag(const std::string& path) {
  auto bag = ros::BagFrames::open(path, {}, 0, [](const auto&, bool) {});
  for (int frames = 0; bag.ok() && frames < 20; ++frames) {
    const auto frame = bag->next();
    if (!frame.ok() || !*frame) return;
    require(!(*frame)->ok() || validate(***frame).ok(), "a frame of a recording is legal");
  }
}

std::vector<std::string> mcap_seeds() {
  using support::McapKind;
  std::vector<std::string> seeds;
  for (const McapKind kind :
       {McapKind::no_chunks, McapKind::plain, McapKind::lz4, McapKind::zstd}) {
    seeds.push_back(support::mcap_of(support::recording(1), kind));
  }
  return seeds;
}

std::vector<std::string> sqlite_seeds() {
  const std::string path = file_of("", "seed.db3");
  support::write_db3(path, support::recording(1));
  std::ifstream file(path, std::ios::binary);
  return {std::string(std::istreambuf_iterator<char>(file), {})};
}

constexpr int kMostDecompressed_mb = 512 + 1;  // of a chunk or a message

}  // namespace

std::vector<Target> recording_targets() {
  return {{"recording", "camera/oni_file.cpp", run_recording, recording_seeds, 4096},
          {"mcap", "ros/mcap_reader.cpp",
           [](std::string_view bytes) { run_bag(file_of(bytes, "a.mcap")); }, mcap_seeds, 65536,
           kMostDecompressed_mb},
          {"sqlite_bag", "ros/sqlite_bag.cpp",
           [](std::string_view bytes) { run_bag(file_of(bytes, "a.db3")); }, sqlite_seeds, 65536,
           kMostDecompressed_mb}};
}

}  // namespace bpa::fuzz
