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

#include <unistd.h>
#include <zlib.h>

#include "core/base/concat.hpp"

namespace bpa::io {
namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
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

Status make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  return unavailable(path, " cannot be made: ", error ? error.message() : "it is not a folder");
}

Status write_file(const std::string& path, std::string_view bytes) {
  const fs::path parent = fs::path(path).parent_path();
  if (!parent.empty()) {
    if (Status status = make_folder(parent.string()); !status.ok()) return status;
  }
  const std::string temporary = path + ".part" + std::to_string(::getpid());
  bool written = false;
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    written = out.good();
  }
  if (written && std::rename(temporary.c_str(), path.c_str()) == 0) return {};
  std::remove(temporary.c_str());
  return unavailable(path, " cannot be written");
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t seed) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  return static_cast<std::uint32_t>(::crc32_z(seed, data, bytes.size()));
}

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace bpa::io
