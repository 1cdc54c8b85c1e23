// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/doctor/finding.hpp"

namespace bpa::test {

/// What is wrong, for comparison; everything else of a finding must be said too.
inline std::vector<std::string> whats(const doctor::Findings& findings) {
  std::vector<std::string> out;
  for (const doctor::Finding& finding : findings) {
    EXPECT_FALSE(finding.why.empty()) << finding.what;
    EXPECT_FALSE(finding.remedy.empty()) << finding.what;
    out.push_back(finding.what);
  }
  return out;
}

using Whats = std::vector<std::string>;

}  // namespace bpa::test
