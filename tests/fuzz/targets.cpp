// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace fs = std::filesystem;
namespace {

struct OwnFolder {
  fs::path path = fs::temp_directory_path() / ("bpa_fuzz_" + std::to_string(::getpid()));

  OwnFolder() { fs::create_directories(path); }
  ~OwnFolder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
};

}  // namespace

std::vector<Target> targets() {
  std::vector<Target> all;
  for (const auto& of_file :
       {image_targets, cloud_targets, mesh_targets, model_targets, data_set_targets,
        settings_targets, message_targets, frame_targets, recording_targets, web_targets}) {
    for (const Target& target : of_file()) all.push_back(target);
  }
  return all;
}

void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

std::string file_of(std::string_view bytes, const std::string& name) {
  static const OwnFolder folder;
  const fs::path path = folder.path / name;
  if (name.find('/') != std::string::npos) fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
  return path.string();
}

}  // namespace bpa::fuzz
