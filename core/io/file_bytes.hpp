// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/status.hpp"
#include "core/io/new_file.hpp"

namespace bpa::io {

/// Whether a file, not a folder, is there. False where that cannot be told: the path is too long,
/// or may not be looked at. std::filesystem throws there unless it is given an error code.
bool is_file(const std::string& path);
/// The same of a folder.
bool is_folder(const std::string& path);

/// A path that another program sent, below `folder`: an absolute path must lie there, a relative
/// one counts from there. The folder must exist; the last part of the path need not. Fails with
/// invalid_argument where the path leaves the folder, has "..", a control character or a symbolic
/// link in it, or is the folder itself; unavailable where the folder cannot be looked at.
Result<std::string> path_below(const std::string& folder, const std::string& path);

/// The whole file. Fails with not_found when it cannot be opened, corrupt when it cannot be read.
Result<std::string> read_file(const std::string& path);

/// A file's bytes where the kernel keeps them: nothing is copied, and programs that map one file
/// share them. They begin on a page and live as long as `owner`.
struct MappedFile {
  std::string_view bytes;
  std::shared_ptr<const void> owner;  ///< Null for bytes that the caller keeps alive.
};

/// Maps a whole file, to be read only. The file may be replaced or removed meanwhile, as
/// write_file() does, but must not be written into. Fails as read_file() does.
Result<MappedFile> map_file(const std::string& path);

/// Replaces the file's content in one step: readers see the old bytes or the new ones, never a
/// part, also after a crash of the machine. Makes missing parent folders. Fails with unavailable.
Status write_file(const std::string& path, std::string_view bytes, Sync sync = Sync::now);

/// Makes a folder and its parents; an existing one is fine. Fails with unavailable.
Status make_folder(const std::string& path);

/// CRC-32 (ISO 3309, as in PNG and zip) of some bytes, continuing from `seed`.
std::uint32_t crc32(std::string_view bytes, std::uint32_t seed = 0);

/// XXH64 of some bytes with seed 0 (xxHash specification 0.1.1; the program xxhsum prints the
/// same). Several times as fast as CRC-32.
std::uint64_t xxh64(std::string_view bytes);

/// The lower-case extension without its dot: "png" for "a/B.PNG".
std::string lower_extension(const std::string& path);

/// What bytes are by how they begin, such as "a JPEG image"; empty where that tells nothing.
std::string content_of(std::string_view bytes);

}  // namespace bpa::io
