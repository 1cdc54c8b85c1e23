// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/advice.hpp"

#include <gtest/gtest.h>

namespace bpa::server {
namespace {

TEST(Advice, IsSaidBesideEmptyResultsAndLoggedOnce) {
  Frame frame;
  frame.frame_id = "cam";
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.depth.assign(64 * 48, 7.0f);
  int logged = 0;
  Advice advice([&logged](LogLevel, const LogMessage&) { ++logged; });
  SceneInterpretations result;
  result.interpretations.resize(1);
  for (int i = 0; i < 2; ++i) {
    const std::string said = advice.on(frame, result, 2.5);
    EXPECT_NE(said.find("the scene is too far away"), std::string::npos) << said;
    EXPECT_EQ(logged, 1);
  }
  frame.frame_id = "another";  // not asked again so soon
  EXPECT_EQ(advice.on(frame, result, 2.5), "");
  result.interpretations[0].placements.resize(1);
  result.interpretations[0].placements[0].presence = 0.9;
  frame.frame_id = "cam";
  EXPECT_EQ(advice.on(frame, result, 2.5), "");
}

}  // namespace
}  // namespace bpa::server
