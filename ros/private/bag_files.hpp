// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "ros/bag_reader.hpp"

namespace bpa::ros {

/// Most bytes of a chunk or a message once it is decompressed: two uncompressed images of 8192 x
/// 8192.
inline constexpr std::uint64_t kMostDecompressed = 536'870'912;

Result<std::unique_ptr<BagReader>> open_mcap(const std::string& path);
Result<std::unique_ptr<BagReader>> open_sqlite_bag(const std::string& path);

/// A zstd frame whose content has `size` bytes; `corrupt` otherwise. Without a size, the frame's
/// own.
Result<std::string> unzstd(std::string_view bytes, std::optional<std::uint64_t> size = {});

}  // namespace bpa::ros
