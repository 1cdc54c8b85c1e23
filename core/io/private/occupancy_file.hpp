// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/base/status.hpp"
#include "core/model/occupancy_grid.hpp"

// occupancy.bin of a model's folder. Little-endian, packed:
//
//   "bpaoccup", version u32, corner of cell (0, 0, 0) 3 f32, side of a cell f32, size 3 i32,
//   number of cells u64; then for each cell in which a ray ended
//   place 3 u16, which buckets have rays u8 (bit 0, bit 1), and for each that has
//   rays u32, occupancy u16 (of 65535), mean position 3 u16 (of the cell's side, from its corner),
//   mean normal 3 i16 (of 32767), standard deviation of normals u16 (of pi, 65535).

namespace bpa::io {

constexpr std::uint32_t kOccupancyVersion = 1;

/// Fails with unsupported when the grid has more than 65535 cells along an axis.
Result<std::string> occupancy_bytes(const OccupancyGrid& grid);

/// What occupancy_bytes wrote, exact to the units above. Fails with corrupt. `name` is for
/// messages.
Result<OccupancyGrid> parse_occupancy(const std::string& bytes, const std::string& name);

}  // namespace bpa::io
