// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL  // nothing to link
#include <xxhash.h>
#include <zlib.h>

#include "core/base/concat.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

// A file descriptor that closes itself.
struct Descriptor {
  int number = -1;
  explicit Descriptor(int n) : number(n) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

}  // namespace

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

Result<std::string> path_below(const std::string& folder, const std::string& path) {
  const auto refused = [&](const char* what) {
    return invalid_argument("the path ", what, "; it must be a path below ", folder);
  };
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error || !is_folder(root.string())) {
    return unavailable(folder, ": there is no such folder", error ? ": " + error.message() : "");
  }
  constexpr std::size_t kLongest = 4096;
  const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (path.empty() || path.size() > kLongest || std::ranges::any_of(path, control)) {
    return refused("is empty, has over 4096 characters or control characters");
  }
  fs::path rest = fs::path(path).lexically_normal();
  if (rest.is_absolute()) {
    // As it was given, or as it is once links are followed.
    const fs::path given = fs::absolute(folder, error).lexically_normal();
    const fs::path below =
        rest.lexically_relative(given.has_filename() ? given : given.parent_path());
    rest = below.empty() || *below.begin() == ".." ? rest.lexically_relative(root) : below;
  }
  fs::path whole = root;
  for (const fs::path& part : rest) {
    if (part == "..") return refused("leaves the folder");
    if (part.empty() || part == ".") continue;
    whole /= part;
    const fs::file_status status = fs::symlink_status(whole, error);
    if (status.type() == fs::file_type::symlink) return refused("goes through a symbolic link");
    if (error && status.type() != fs::file_type::not_found) {
      return refused("cannot be looked at");
    }
  }
  if (whole == root) return refused("is that folder");
  return whole.string();
}

Result<std::string> read_file(const std::string& path) {
  if (is_folder(path)) return invalid_argument(path, " is a folder; a file is needed");
  std::error_code error;
  std::ifstream in(path, std::ios::binary);
  if (!in) return not_found(path, " cannot be opened");
  std::string bytes;
  if (const auto size = fs::file_size(path, error); !error) {
    bytes.resize(size);
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
  }
  if (in.good() || bytes.empty()) {  // more to come, or of no known size, such as a pipe
    in.clear();
    std::ostringstream rest;
    rest << in.rdbuf();
    bytes += std::move(rest).str();
  }
  if (in.bad()) return corrupt(path, " cannot be read");
  return bytes;
}

Result<MappedFile> map_file(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat about {};
  if (file.number < 0 || ::fstat(file.number, &about) != 0) {
    return not_found(path, " cannot be opened");
  }
  if (!S_ISREG(about.st_mode)) return invalid_argument(path, " is no file that can be mapped");
  const auto size = static_cast<std::size_t>(about.st_size);
  if (size == 0) return MappedFile{};  // which mmap refuses
  void* start = ::mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, file.number, 0);
  if (start == MAP_FAILED) return corrupt(path, " cannot be read");
  return MappedFile{
      {static_cast<const char*>(start), size},
      std::shared_ptr<const void>(start, [size](void* memory) { ::munmap(memory, size); })};
}

Status make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  return unavailable(path, " cannot be made: ", error ? error.message() : "it is not a folder");
}

Status write_file(const std::string& path, std::string_view bytes, Sync sync) {
  const fs::path parent = fs::path(path).parent_path();
  if (!parent.empty()) {
    if (Status status = make_folder(parent.string()); !status.ok()) return status;
  }
  auto file = NewFile::create(path, path + ".part" + std::to_string(::getpid()));
  if (!file.ok()) return file.status();
  Status status = file->append(bytes);
  if (status.ok()) status = file->commit(sync);
  if (!status.ok()) file->discard();
  return status;
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t seed) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(::crc32_z(seed, data, bytes.size()));
}

std::uint64_t xxh64(std::string_view bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string content_of(std::string_view bytes) {
  constexpr std::pair<std::string_view, const char*> kContents[] = {
      {"version https://git-lfs",
       "a pointer of Git LFS, not the file itself: git lfs pull gets it"},
      {"<!doctype html", "a web page: its download failed"},
      {"<html", "a web page: its download failed"},
      {"pk\3\4", "a zip archive: unpack it"},
      {"\x1f\x8b", "compressed: unpack it with gunzip"},
      {"iso-10303-21", "a STEP file"},
      {"ply", "a PLY file"},
      {"gltf", "a GLB file"},
      {"\xff\xd8\xff", "a JPEG image"},
      {"\x89png", "a PNG image"},
      {"\x93numpy", "a NumPy array"}};
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  std::string head(bytes.substr(std::min(first, bytes.size()), 32));
  std::ranges::transform(head, head.begin(), [](unsigned char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : static_cast<char>(c);
  });
  for (const auto& [begin, content] : kContents) {
    if (head.starts_with(begin)) return content;
  }
  return "";
}

}  // namespace bpa::io
