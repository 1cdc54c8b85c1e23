// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// RVL, the lossless coding of depth images of A. D. Wilson, "Fast Lossless Depth Image
// Compression", 2017: runs of zeros and of other values, the latter as differences to the last one,
// all numbers in groups of three bits with a fourth that says that more follow, eight groups to a
// little-endian word, the first one in its highest bits.

namespace bpa::server {

/// Decodes exactly `count` values. False when the stream is too short or does not fit the count.
bool decode_rvl(const std::uint8_t* data, std::size_t size, std::size_t count,
                std::vector<std::uint16_t>& values);

}  // namespace bpa::server
