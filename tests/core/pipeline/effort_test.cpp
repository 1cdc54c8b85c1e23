// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// How much work a search does: counts, which unlike times are the same on every machine.
#include <cstdio>

#include "core/pipeline/detector.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

// Limits of each count, about 1.2 times what this prints:
//   ctest --preset release -R pipeline/effort --verbose
// Fewer are welcome: lower the limits with them. More need a reason in the message of the commit.
constexpr SearchEffort kMost{.rounds = 3,
                             .sampled_poses = 3800,
                             .pose_checks = 4200,
                             .alignments = 360,
                             .quick_scores = 1420,
                             .full_scores = 20};

class EffortOf : public test::LScene {
 protected:
  static SearchEffort searched(const std::vector<test::Solid>& solids, int num_threads = 0,
                               double budget_ms = 0, const RoundOptions& rounds = {}) {
    const auto library = std::make_shared<ModelLibrary>();
    EXPECT_TRUE(library->add(l_).ok());
    EXPECT_TRUE(library->add(brick_).ok());
    const Frame frame = test::render(solids, test::kinect_camera(), 1, 8).frame;
    DetectRequest request;
    request.num_threads = num_threads;
    request.budget_ms = budget_ms;
    DetectorOptions options;
    options.rounds = rounds;
    const auto found = Detector(library, options).detect(frame, request);
    EXPECT_TRUE(found.ok()) << found.status().message;
    return found.ok() ? found->effort : SearchEffort{};
  }
};

TEST_F(EffortOf, StaysWithinItsLimits) {
  const SearchEffort effort = searched(everything());
  for (const auto& [name, count] : kEffortCounts) {
    std::printf("%-14s %7ld of %7ld\n", name, static_cast<long>(effort.*count),
                static_cast<long>(kMost.*count));
    EXPECT_GT(effort.*count, 0) << name;
    EXPECT_LE(effort.*count, kMost.*count) << name;
  }
}

TEST_F(EffortOf, IsTheSameForAnyThreads) {
  const SearchEffort one = searched(everything(), 1);
  for (const int threads : {2, 8}) EXPECT_EQ(searched(everything(), threads), one) << threads;
}

TEST_F(EffortOf, IsLessWhereMoreMayBeMissed) {
  RoundOptions options;
  options.max_missed = 0.01;
  const SearchEffort patient = searched(everything(), 0, 0, options);
  options.max_missed = 1;
  EXPECT_LT(searched(everything(), 0, 0, options).sampled_poses, patient.sampled_poses);
}

TEST_F(EffortOf, IsLessWhereNothingIsThereOrTimeIsShort) {
  const SearchEffort all = searched(everything());
  EXPECT_LT(searched(table_only()).full_scores, all.full_scores);
  EXPECT_LT(searched(everything(), 0, 1e-6).pose_checks, all.pose_checks);
}

}  // namespace
}  // namespace bpa
