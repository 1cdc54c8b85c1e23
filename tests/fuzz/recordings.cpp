// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Recordings of OpenNI2.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "camera/oni_file.hpp"
#include "tests/fuzz/target.hpp"

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

}  // namespace

std::vector<Target> recording_targets() {
  return {{"recording", "camera/oni_file.cpp", run_recording, recording_seeds, 4096}};
}

}  // namespace bpa::fuzz
