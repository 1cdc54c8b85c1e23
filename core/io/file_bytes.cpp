// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <unistd.h>

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

// Table k gives the effect of a byte that k further bytes follow, so that eight are done at once.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t c = n;
    for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    tables[0][n] = c;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t n = 0; n < 256; ++n) {
      const std::uint32_t c = tables[k - 1][n];
      tables[k][n] = tables[0][c & 0xff] ^ (c >> 8);
    }
  }
  return tables;
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return invalid_argument(path + " is a folder; a file is needed");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) return Status(StatusCode::not_found, path + " cannot be opened");
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
  if (in.bad()) return Status(StatusCode::corrupt, path + " cannot be read");
  return bytes;
}

Status make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  return Status(StatusCode::unavailable,
                path + " cannot be made: " + (error ? error.message() : "it is not a folder"));
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
  return Status(StatusCode::unavailable, path + " cannot be written");
}

std::uint32_t crc32(std::string_view bytes, std::uint32_t seed) {
  static const CrcTables kTables = make_crc_tables();
  const auto* byte = reinterpret_cast<const std::uint8_t*>(bytes.data());
  std::size_t left = bytes.size();
  std::uint32_t crc = ~seed;
  for (; left >= 8; left -= 8, byte += 8) {
    const std::uint32_t low =
        crc ^ (byte[0] | byte[1] << 8 | byte[2] << 16 | static_cast<std::uint32_t>(byte[3]) << 24);
    crc = kTables[7][low & 0xff] ^ kTables[6][(low >> 8) & 0xff] ^ kTables[5][(low >> 16) & 0xff] ^
          kTables[4][low >> 24] ^ kTables[3][byte[4]] ^ kTables[2][byte[5]] ^ kTables[1][byte[6]] ^
          kTables[0][byte[7]];
  }
  for (; left > 0; --left, ++byte) crc = kTables[0][(crc ^ *byte) & 0xff] ^ (crc >> 8);
  return ~crc;
}

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace bpa::io
