// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/cloud/frame.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "core/model/library.hpp"
#include "core/result/interpretation.hpp"

namespace bpa::draw {

/// A picture of a frame, and how many instances and placements are which.
struct JudgedFrame {
  io::ColorImage picture;
  int found = 0;   ///< Instances of which 10 % or more is visible, with a right placement.
  int missed = 0;  ///< The same without a right placement.
  int wrong = 0;   ///< False positives.
};

/// Truth (left) beside the result (right). Missed instances are outlined in red as MISSED on the
/// left, false positives (eval::right_cost) in red as FALSE on the right. Objects that the library
/// does not hold cannot be drawn and are left out.
JudgedFrame truth_beside_result(const Frame& frame, const std::vector<io::BopInstance>& truth,
                                const Interpretation& result, const ModelLibrary& library,
                                const std::string& caption);

/// The indices of frames by falling number of errors, in order where equal.
std::vector<std::size_t> worst_first(const std::vector<JudgedFrame>& frames);

}  // namespace bpa::draw
