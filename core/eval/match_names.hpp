// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/io/results.hpp"
#include "core/io/tracks.hpp"

namespace bpa::eval {

/// Names of models by their numbers (obj_id).
using ModelNames = std::map<int, std::string>;

/// The number in `to` of each model of `from`: that of its name where both lists have names, else
/// its own. A model that `to` lacks is missing. "obj_000001" and an empty text are no names; the
/// characters that a library does not keep in names do not count.
std::map<int, int> matched(const ModelNames& from, const ModelNames& to);

/// Gives placements the numbers that `known` has for their models. Takes out those whose name it
/// lacks, and returns these names. What has no name keeps its number.
std::set<std::string> number_by_name(const ModelNames& known,
                                     std::vector<io::FrameResult>& results);
/// The same of tracks.
std::set<std::string> number_by_name(const ModelNames& known,
                                     std::vector<io::TrackResult>& results);

}  // namespace bpa::eval
