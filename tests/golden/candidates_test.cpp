// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Candidates and interpretations of simulated frames, bit for bit, for one and for two threads.
// candidates.txt holds them as this test writes them with BPA_WRITE_GOLDEN=1 in the environment.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/pipeline/detector.hpp"
#include "tests/support/l_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

std::string exact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, " %a", value);
  return text;
}

std::string exact(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  std::string out;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) out += exact(value);
  for (const double value : pose.translation) out += exact(value);
  return out;
}

void append(const Placement& placement, std::string& out) {
  out += "  " + placement.model + exact(placement.frame_from_object) + exact(placement.score) +
         exact(placement.probability) + exact(placement.covariance.trace()) + "\n   ";
  for (const ScoreComponent& component : placement.components) {
    out += " " + component.name + exact(component.value);
  }
  out += "\n";
  for (const PoseAlternative& alternative : placement.alternatives) {
    out += "    or" + exact(alternative.frame_from_object) + exact(alternative.weight) + "\n";
  }
}

std::string record(const FrameTrace& trace, const SceneInterpretations& result) {
  std::string out = "candidates\n";
  for (const detect::Candidate& c : trace.candidates) {
    out += "  " + c.model->name + exact(c.pose()) + exact(c.score) + exact(c.probability) + " " +
           std::to_string(c.explained.size()) + "\n";
  }
  for (const Interpretation& interpretation : result.interpretations) {
    out +=
        "interpretation" + exact(interpretation.score) + exact(interpretation.probability) + "\n";
    for (const Placement& placement : interpretation.placements) append(placement, out);
  }
  return out;
}

class Golden : public test::LScene {
 protected:
  static std::vector<Frame> frames() {
    const Pose other_side = test::look_at({-0.5, -0.3, 0.6}, {0, 0, 0});
    const Pose behind = other_side * test::standing_at(0.02, 0.10, 0.02, 2.1);
    auto hidden = test::together({test::table(other_side)}, test::l_solids(behind));
    hidden.push_back(test::brick_solid(other_side * test::standing_at(-0.04, 0.01, 0.025, 0.3)));
    hidden.push_back(test::brick_solid(other_side * test::standing_at(-0.03, 0.01, 0.075, 1.2)));
    return {test::render(everything(), test::kinect_camera(), 1, 8).frame,
            test::render(hidden, test::kinect_camera(), 1, 3).frame,
            test::render(table_only(), test::kinect_camera(), 1, 5).frame};
  }
  static std::string run(int num_threads) {
    auto library = std::make_shared<ModelLibrary>();
    EXPECT_TRUE(library->add(l_).ok() && library->add(brick_).ok());
    const Detector detector(library, {});
    DetectRequest request;
    request.num_threads = num_threads;
    std::string out;
    for (const Frame& frame : frames()) {
      FrameTrace trace;
      const auto result = detector.detect(frame, request, &trace);
      EXPECT_TRUE(result.ok()) << result.status().message;
      if (result.ok()) out += "frame\n" + record(trace, *result);
    }
    return out;
  }
};

TEST_F(Golden, CandidatesAndInterpretationsKeepTheirBits) {
  const std::string file = std::string(BPA_SOURCE_DIR) + "/tests/golden/candidates.txt";
  const std::string now = run(1);
  EXPECT_EQ(now, run(2)) << "one and two threads differ";
  if (std::getenv("BPA_WRITE_GOLDEN")) {
    std::ofstream(file) << now;
    return;
  }
  EXPECT_EQ(now, test::slurp(file));
}

}  // namespace
}  // namespace bpa
