// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "camera/oni_file.hpp"
#include "core/io/model_file.hpp"
#include "tests/support/process.hpp"

// A process that saves a model, a file and a recording is cut off before each call that changes
// files, and loses what it did not sync. Each of the three is then whole: the old one or the new
// one.

namespace bpa {
namespace {

namespace fs = std::filesystem;
constexpr int kCutOff = 99;  // its exit code then

int save(const std::string& folder, const std::string& version, int cut_at) {
  const std::string at = std::to_string(cut_at);
  const std::string log = support::scratch_folder() + "/save.log";
  std::vector<std::string> command = {"/usr/bin/env",
                                      "LD_PRELOAD=" BPA_BINARY_DIR "/tests/bpa-power-cut.so",
                                      "BPA_POWER_CUT_AT=" + at,
                                      BPA_BINARY_DIR "/tests/bpa-save-files",
                                      folder,
                                      version};
  const int code = support::run(command, log);
  EXPECT_TRUE(code == 0 || code == kCutOff) << support::read_text(log);
  return code;
}

TEST(PowerCut, LeavesTheOldOrTheNew) {
  const std::string folder = support::scratch_folder() + "/power";
  fs::create_directories(folder);
  ASSERT_EQ(save(folder, "1", 1'000'000), 0);
  const double old_size = 0.05, new_size = 0.06;
  int cuts = 0, old_ones = 0;
  int code = kCutOff;
  for (int at = 1; at < 1000 && code == kCutOff; ++at) {
    code = save(folder, "2", at);
    cuts += code == kCutOff ? 1 : 0;
    const auto model = io::load_model(folder + "/library", "box");
    ASSERT_TRUE(model.ok()) << "cut at " << at << ": " << model.status().message;
    float size = 0;
    for (const Eigen::Vector3f& point : model->surface.points) {
      size = std::max(size, point.cwiseAbs().maxCoeff());
    }
    const bool is_old = std::abs(static_cast<double>(size) - old_size) < 1e-3;
    EXPECT_TRUE(is_old || std::abs(static_cast<double>(size) - new_size) < 1e-3) << size;
    old_ones += is_old ? 1 : 0;
    const std::string text = support::read_text(folder + "/settings");
    EXPECT_TRUE(text == "version 1" || text == "version 2") << "cut at " << at << ": " << text;
    EXPECT_TRUE(camera::inspect_oni_file(folder + "/1.oni").ok());
    const std::string recording = folder + "/2.oni";
    if (fs::exists(recording)) {
      const auto info = camera::inspect_oni_file(recording);
      EXPECT_TRUE(info.ok()) << "cut at " << at << ": " << info.status().message;
    }
  }
  EXPECT_EQ(code, 0);
  EXPECT_GT(cuts, 20);
  EXPECT_GT(old_ones, 10);
  EXPECT_TRUE(fs::exists(folder + "/2.oni"));
  EXPECT_EQ(support::read_text(folder + "/settings"), "version 2");
}

}  // namespace
}  // namespace bpa
