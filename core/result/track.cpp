// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/result/track.hpp"

namespace bpa {

std::string_view name_of(TrackState state) {
  constexpr std::string_view kNames[] = {"tentative", "confirmed", "occluded", "lost"};
  return kNames[static_cast<int>(state)];
}

}  // namespace bpa
