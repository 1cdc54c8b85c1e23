// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa simulate writes data sets that our own reader takes, the same for any number of threads.
#include <cstdlib>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "core/io/bop_dataset.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

int run(const std::string& arguments) {
  const std::string command =
      std::string(BPA_BINARY_DIR) + "/bin/bpa simulate " + arguments + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

TEST(Simulate, ScenesAreABopSet) {
  const test::TemporaryFolder folder;
  const std::string what = "scenes --scenes 2 --seed 4 --models cube,gear,can --objects 2,3 --out ";
  ASSERT_EQ(run(what + folder / "one" + " --threads 1"), 0);
  ASSERT_EQ(run(what + folder / "two" + " --threads 2"), 0);
  const auto models = io::read_bop_models(folder / "one");
  ASSERT_TRUE(models.ok()) << models.status().message;
  ASSERT_EQ(models->size(), 3u);
  EXPECT_EQ((*models)[0].name, "cube");
  EXPECT_EQ((*models)[0].symmetry.discrete.size(), 23u);
  EXPECT_NEAR((*models)[0].diameter, 0.0957, 0.002);
  EXPECT_EQ((*models)[2].symmetry.continuous.size(), 1u);
  const auto frames = io::read_bop_frames(folder / "one", "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  ASSERT_EQ(frames->size(), 2u);
  for (const io::BopFrame& frame : *frames) {
    EXPECT_GE(frame.truth.size(), 2u);
    const auto loaded = io::load_bop_frame(frame);
    ASSERT_TRUE(loaded.ok());
    EXPECT_TRUE(validate(*loaded).ok());
  }
  for (const char* name : {"/test/000002/depth/000000.png", "/test/000002/scene_gt.json",
                           "/test/000001/rgb/000000.png", "/models/obj_000002.ply"}) {
    const std::string bytes = test::slurp(folder / "one" + name);
    EXPECT_FALSE(bytes.empty()) << name;
    EXPECT_EQ(bytes, test::slurp(folder / "two" + name)) << name;
  }
}

TEST(Simulate, MeshesOfABopSetKeepTheirNamesAndSymmetries) {
  const test::TemporaryFolder folder;
  const std::string what = "scenes --scenes 1 --seed 4 --objects 1,1 ";
  ASSERT_EQ(run(what + "--models cube,can --out " + folder / "one"), 0);
  ASSERT_EQ(run(what + "--meshes " + folder / "one" + "/models --out " + folder / "two"), 0);
  const auto one = io::read_bop_models(folder / "one"), two = io::read_bop_models(folder / "two");
  ASSERT_TRUE(one.ok() && two.ok());
  ASSERT_EQ(two->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*two)[i].name, (*one)[i].name);
    EXPECT_EQ((*two)[i].symmetry.discrete.size(), (*one)[i].symmetry.discrete.size());
    EXPECT_EQ((*two)[i].symmetry.continuous.size(), (*one)[i].symmetry.continuous.size());
    EXPECT_NEAR((*two)[i].diameter, (*one)[i].diameter, 1e-4);
  }
  EXPECT_EQ(run(what + "--ambiguous 1 --models cube --out " + folder / "x"), 1) << "no handle";
}

TEST(Simulate, ATurntableScanOfAMesh) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(run("turntable --object l_brick --step-deg 90 --positions 1 --out " + folder / "a"), 0);
  const std::string mesh = folder / "a" + "/models/obj_000001.ply";
  EXPECT_EQ(run("turntable --step-deg 90 --unit m --mesh " + mesh + " --out " + folder / "b"), 1);
  EXPECT_EQ(run("turntable --step-deg 90 --out " + folder / "b"), 2);
  ASSERT_EQ(run("turntable --step-deg 90 --positions 1 --mesh " + mesh + " --out " + folder / "b"),
            0);  // millimetres, as guessed
  const auto frames = io::read_bop_frames(folder / "b", "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  EXPECT_EQ(frames->size(), 4u);
}

}  // namespace
}  // namespace bpa
