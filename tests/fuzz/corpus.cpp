// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Calls fuzz targets on files. Usage:
//
// fuzz_corpus: lists the targets: name, largest input in bytes, largest allocation in MB, files
// that decode.
//
// fuzz_corpus FOLDER: calls each target on its seeds and on the files of FOLDER/TARGET.
//
// fuzz_corpus --seeds FOLDER TARGET: writes the seeds of a target.
//
// fuzz_corpus --on FILE TARGET: calls a target on a file.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/target.hpp"

namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<fs::path> files_of(const fs::path& folder) {
  if (!fs::is_directory(folder)) return {};
  const fs::directory_iterator entries(folder);
  std::vector<fs::path> files(begin(entries), end(entries));
  std::sort(files.begin(), files.end());
  return files;
}

/// Prints each name first: the last line of a crash tells which input it was.
void run(const bpa::fuzz::Target& target, const fs::path& folder) {
  std::fprintf(stderr, "%s: its seeds\n", target.name);
  for (const std::string& seed : target.seeds()) target.run(seed);
  for (const fs::path& file : files_of(folder / target.name)) {
    std::fprintf(stderr, "%s\n", file.c_str());
    target.run(bytes_of(file));
  }
}

int write_seeds(const bpa::fuzz::Target& target, const fs::path& folder) {
  fs::create_directories(folder);
  int number = 0;
  for (const std::string& seed : target.seeds()) {
    std::ofstream(folder / ("seed_" + std::to_string(number++)), std::ios::binary) << seed;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<bpa::fuzz::Target> targets = bpa::fuzz::targets();
  if (argc < 2) {
    for (const auto& t : targets) {
      std::printf("%s %d %d %s\n", t.name, t.max_bytes, t.malloc_mb, t.sources);
    }
    return 0;
  }
  if (argc == 2) {
    for (const fs::path& folder : files_of(argv[1])) {
      const auto is_of = [&](const auto& t) { return folder.filename() == t.name; };
      if (std::any_of(targets.begin(), targets.end(), is_of)) continue;
      std::fprintf(stderr, "%s is the folder of no target\n", folder.c_str());
      return 2;
    }
    for (const auto& target : targets) run(target, argv[1]);
    return 0;
  }
  const std::string option = argv[1], path = argv[2], name = argc > 3 ? argv[3] : "";
  const auto target =
      std::find_if(targets.begin(), targets.end(), [&](const auto& t) { return t.name == name; });
  if (target == targets.end() || (option != "--seeds" && option != "--on")) {
    std::fprintf(stderr, "there is no target %s, or no option %s\n", name.c_str(), option.c_str());
    return 2;
  }
  if (option == "--seeds") return write_seeds(*target, path);
  target->run(bytes_of(path));
  return 0;
}
