// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace bpa {

/// A median depth that no depth camera has, metres: such numbers are millimetres.
inline constexpr double kMillimetresFrom = 100;

/// The median of some of the depths that are finite and positive; nothing where none is.
std::optional<double> some_median(const std::vector<float>& depths);

/// What people should know of depths that were taken for millimetres.
std::string millimetre_note(double median);

/// Depths in metres, of metres or, told by their median, of millimetres. Returns the note then.
std::string to_metres(std::vector<float>& depths);

}  // namespace bpa
