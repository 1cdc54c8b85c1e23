// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace bpa {

/// A median depth that no depth camera has, metres: such numbers are millimetres.
inline constexpr double kMillimetresFrom = 100;

/// Turns depths whose median says that they are millimetres into metres. Returns what people should
/// know then, else an empty text.
std::string to_metres(std::vector<float>& depths);

}  // namespace bpa
