// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The program bpa as a user meets it: bad input is one clear line and exit code 1, wrong usage
// is 2.
#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "core/base/random.hpp"
#include "core/eval/pose_errors.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/results.hpp"
#include "core/io/tracks.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/system/cli/box_scene.hpp"

namespace bpa {
namespace {

using test::box;
using test::box_frame;
using test::box_pose;
using test::kCamera;
using test::Outcome;
using test::run;
using test::slurp;
using test::spill;

/// Exit code 1 and exactly one line, which has all the words.
void expect_failure(const std::string& arguments, const std::vector<std::string>& words) {
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.out;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
  EXPECT_EQ(outcome.out.rfind("bpa: ", 0), 0u) << outcome.out;
  for (const std::string& word : words) {
    EXPECT_NE(outcome.out.find(word), std::string::npos)
        << "no \"" << word << "\" in " << outcome.out;
  }
}

/// A library with one box, and a good frame to spoil.
class BadInput : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(io::write_ply(folder_ / "box.ply", box(0.06f, 0.04f, 0.09f)).ok());
    const Outcome made = run("model from-mesh " + (folder_ / "box.ply") +
                             " --name box --views 0 --library " + (folder_ / "L"));
    ASSERT_EQ(made.code, 0) << made.out;
    write_depth("d.png", 160, 120, 700);
    io::ColorImage color{160, 120, {}};
    color.pixels.assign(3 * 160 * 120, 100);
    ASSERT_TRUE(io::write_color_png(folder_ / "c.png", color).ok());
    ASSERT_TRUE(io::write_file(folder_ / "camera.json", io::camera_json(kCamera, 1.0)).ok());
  }

  void write_depth(const std::string& name, int width, int height, std::uint16_t value) {
    io::GrayImage depth{width, height, {}};
    depth.pixels.assign(static_cast<std::size_t>(width * height), value);
    ASSERT_TRUE(io::write_gray_png(folder_ / name, depth).ok());
  }

  std::string detect(const std::string& depth, const std::string& camera = "camera.json",
                     const std::string& more = "") const {
    return "detect --library " + (folder_ / "L") + " --depth " + (folder_ / depth) + " --color " +
           (folder_ / "c.png") + " --camera " + (folder_ / camera) + " " + more;
  }

  test::TemporaryFolder folder_;
};

TEST_F(BadInput, DepthOfTheWrongSize) {
  write_depth("small.png", 80, 60, 700);
  expect_failure(detect("small.png"), {"depth", "80x60", "160x120"});
  ASSERT_TRUE(
      io::write_file(folder_ / "s.json", io::camera_json({80, 60, 70, 70, 40, 30}, 1.0)).ok());
  expect_failure(detect("small.png", "s.json"), {"depth", "80x60", "colour", "160x120"});
}

TEST_F(BadInput, DepthOfNothingButZero) {
  write_depth("zero.png", 160, 120, 0);
  expect_failure(detect("zero.png"), {"depth", "0 valid pixels", "500"});
}

TEST_F(BadInput, DepthOfEightBits) {
  ASSERT_TRUE(
      io::write_mask_png(folder_ / "m.png", 160, 120, std::vector<std::uint8_t>(160 * 120, 90))
          .ok());
  expect_failure(detect("m.png"), {"m.png", "8 bits", "must have 1 of 16"});
}

TEST_F(BadInput, DepthInAnotherUnitIsSaidWithTheRemedy) {
  write_depth("units.png", 160, 120, 65000);
  ASSERT_TRUE(io::write_file(folder_ / "mm.json", io::camera_json(kCamera, 20.0)).ok());
  expect_failure(detect("units.png", "mm.json"), {"wrong unit", "1300 m", "Correct the scale"});
  // Legal, but nothing is found so near.
  write_depth("near.png", 160, 120, 90);
  const Outcome near = run(detect("near.png"));
  EXPECT_EQ(near.code, 0) << near.out;
  EXPECT_NE(near.out.find("the scene is too near: the median depth is 90 mm"), std::string::npos)
      << near.out;
}

TEST_F(BadInput, OneFrameOfSeveralDoesNotEndTheList) {
  spill(folder_ / "cut.png", slurp(folder_ / "d.png").substr(0, 90));
  const Outcome outcome =
      run("detect --library " + (folder_ / "L") + " --depth " + (folder_ / "d.png") + " " +
          (folder_ / "cut.png") + " " + (folder_ / "d.png") + " --camera " +
          (folder_ / "camera.json") + " --json " + (folder_ / "r.json"));
  EXPECT_EQ(outcome.code, 1) << outcome.out;
  EXPECT_NE(outcome.out.find("not searched: " + (folder_ / "cut.png")), std::string::npos);
  EXPECT_NE(outcome.out.find("1 of 3 frames could not be searched"), std::string::npos);
  const auto results = io::read_results_json(folder_ / "r.json");
  ASSERT_TRUE(results.ok());
  ASSERT_EQ(results->size(), 2u);
  EXPECT_EQ(results->at(1).im_id, 2);
}

/// One depth image that is cut short, and one camera that is none, among three.
TEST_F(BadInput, OneFrameOfADataSetDoesNotEndIt) {
  io::BopSceneWriter writer(folder_ / "set", "test", 1);
  for (int image = 0; image < 3; ++image) {
    Frame frame = box_frame(box_pose());
    frame.stamp_ns = 1'000'000'000 + 33'000'000 * image;
    ASSERT_TRUE(writer.add(image, frame, {}).ok());
  }
  ASSERT_TRUE(writer.finish().ok());
  const std::string scene = folder_ / "set/test/000001";
  spill(scene + "/depth/000001.png", slurp(scene + "/depth/000001.png").substr(0, 20));
  std::string cameras = slurp(scene + "/scene_camera.json");
  const std::size_t last = cameras.find("140.0", cameras.find("\"2\""));
  ASSERT_NE(last, std::string::npos);
  spill(scene + "/scene_camera.json", cameras.replace(last, 5, "0.0"));
  const std::string of_set =
      " --library " + (folder_ / "L") + " --bop " + (folder_ / "set") + " --json ";
  Outcome outcome = run("detect" + of_set + (folder_ / "r.json"));
  EXPECT_EQ(outcome.code, 1);
  for (const char* words : {"000001.png is truncated", "scene_camera.json: 2: fx is 0",
                            "2 of 3 frames could not be searched"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
  }
  const auto results = io::read_results_json(folder_ / "r.json");
  ASSERT_TRUE(results.ok() && results->size() == 1u);
  outcome = run("track" + of_set + (folder_ / "t.json"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.out.find("2 of 3 frames could not be followed"), std::string::npos)
      << outcome.out;
  const auto tracks = io::read_tracks_json(folder_ / "t.json");
  ASSERT_TRUE(tracks.ok() && tracks->size() == 1u);
  // Only those that are asked for are read; of these, all must be there.
  EXPECT_EQ(run("detect" + of_set + (folder_ / "r.json") + " --images 0").code, 0);
  expect_failure("detect" + of_set + (folder_ / "r.json") + " --images 0,77", {"no image 77"});
}

TEST_F(BadInput, ProbabilityIsAtLeastWhatIsAskedFor) {
  write_depth("wall.png", 160, 120, 700);
  for (const char* least : {"1.5", "-0.1"}) {
    EXPECT_EQ(run(detect("d.png", "camera.json", std::string("--min-probability ") + least)).code,
              2);
  }
  io::GrayImage depth{160, 120, {}};
  for (const float z : box_frame(box_pose()).depth) {
    depth.pixels.push_back(static_cast<std::uint16_t>(1000 * z));
  }
  ASSERT_TRUE(io::write_gray_png(folder_ / "box.png", depth).ok());
  const auto found = [&](const char* least) {
    const Outcome outcome =
        run(detect("box.png", "camera.json",
                   "--json " + (folder_ / "r.json") + " --min-probability " + least));
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    const auto results = io::read_results_json(folder_ / "r.json");
    return results.ok() ? results->front().interpretations.front().placements.size() : 99;
  };
  EXPECT_GE(found("0.01"), 1u);
  EXPECT_EQ(found("1"), 0u);
}

/// As the server does; an unknown lens is refused by its name.
TEST_F(BadInput, LensesOfCameraFilesAreTakenOut) {
  const auto said = [&](const std::string& model, const std::string& more) {
    spill(folder_ / "lens.yaml",
          "width: 160\nheight: 120\nK: [140, 0, 79.5, 0, 140, 59.5, 0, 0, 1]\n"
          "distortion_model: " +
              model + "\nD: [0.1, 0, 0, 0]\n");
    return run(detect("d.png", "lens.yaml", more));
  };
  EXPECT_NE(said("plumb_bob", "").out.find("its distortion is taken out of the images"),
            std::string::npos);
  EXPECT_NE(said("plumb_bob", "--rectified").out.find("its distortion is not used"),
            std::string::npos);
  const Outcome other = said("panoramic", "");
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.out.find("panoramic"), std::string::npos) << other.out;
}

TEST_F(BadInput, CloudOfNothingButNan) {
  std::ostringstream pcd;
  pcd << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 40\nHEIGHT 30\n"
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1200\nDATA ascii\n";
  for (int i = 0; i < 1200; ++i) pcd << "nan nan nan\n";
  spill(folder_ / "nan.pcd", pcd.str());
  expect_failure("detect --library " + (folder_ / "L") + " --pcd " + (folder_ / "nan.pcd"),
                 {"nan.pcd", "0 finite points", "500"});
}

TEST_F(BadInput, FocalLengthOfZero) {
  spill(folder_ / "zero.json", R"({"fx": 0.0, "fy": 140, "cx": 80, "cy": 60})");
  expect_failure(detect("d.png", "zero.json"), {"zero.json", "fx is 0", "must be positive"});
}

TEST_F(BadInput, TruncatedPng) {
  spill(folder_ / "cut.png", slurp(folder_ / "d.png").substr(0, 90));
  expect_failure(detect("cut.png"), {"cut.png", "truncated"});
  spill(folder_ / "c.png", slurp(folder_ / "c.png").substr(0, 100));
  expect_failure(detect("d.png"), {"c.png", "truncated"});
}

TEST_F(BadInput, MeshInTheWrongUnit) {
  const std::string library = " --name b --library " + (folder_ / "M");
  ASSERT_TRUE(io::write_ply(folder_ / "mm.ply", box(0.06f, 0.04f, 0.09f), 1000).ok());
  expect_failure("model from-mesh " + (folder_ / "mm.ply") + library + " --unit m",
                 {"mm.ply", "3 m", "If its unit is another", "--unit mm"});
  const Outcome scaled =
      run("model from-mesh " + (folder_ / "mm.ply") + library + " --scale 0.001");
  EXPECT_EQ(scaled.code, 0) << scaled.out;
  const Outcome guessed = run("model from-mesh " + (folder_ / "mm.ply") + library);
  EXPECT_EQ(guessed.code, 0) << guessed.out;
  EXPECT_NE(guessed.out.find("mm.ply: assuming millimetres: 120 x 80 x 180 mm"), std::string::npos)
      << guessed.out;
  expect_failure("model from-mesh " + (folder_ / "box.ply") + library + " --scale 0.001",
                 {"box.ply", "0.005", "scale"});
}

TEST_F(BadInput, EmptyAndMissingLibraries) {
  std::filesystem::create_directories(folder_ / "empty");
  const std::string rest =
      " --depth " + (folder_ / "d.png") + " --camera " + (folder_ / "camera.json");
  expect_failure("detect --library " + (folder_ / "empty") + rest,
                 {"library", "empty", "at least one"});
  expect_failure("detect --library " + (folder_ / "none") + rest, {"library", "none"});
  expect_failure("model list --library " + (folder_ / "empty"), {"library", "empty"});
  expect_failure(detect("d.png", "camera.json", "--models box,teapot"), {"teapot"});
}

TEST_F(BadInput, DamagedModel) {
  const std::string path = folder_ / "L/box/surface.ply";
  const std::string bytes = slurp(path);
  spill(path, bytes.substr(0, bytes.size() - 1));
  expect_failure(detect("d.png"), {"surface.ply", "truncated"});
  // The others are listed and found all the same, and it can be made again.
  const std::string make_box = "model from-mesh " + (folder_ / "box.ply") +
                               " --views 0 --library " + (folder_ / "L") + " --name ";
  ASSERT_EQ(run(make_box + "other").code, 0);
  Outcome listed = run("model list --library " + (folder_ / "L"));
  EXPECT_EQ(listed.code, 1);
  for (const char* words : {"  other  ", "bpa: ", "1 model cannot be read", "box (", "truncated"}) {
    EXPECT_NE(listed.out.find(words), std::string::npos) << words << " in " << listed.out;
  }
  EXPECT_EQ(listed.out.find("  box  "), std::string::npos) << listed.out;
  EXPECT_EQ(run(detect("d.png", "camera.json", "--models other")).code, 0);
  expect_failure(detect("d.png", "camera.json", "--models other,box"), {"surface.ply"});
  ASSERT_EQ(run(make_box + "box").code, 0);
  EXPECT_EQ(run("model list --library " + (folder_ / "L")).code, 0);
}

TEST_F(BadInput, ConfigurationFile) {
  spill(folder_ / "a.yaml", "max_range_m: 2\nmax_rnage: 3\n");
  expect_failure(detect("d.png", "camera.json", "--config " + (folder_ / "a.yaml")),
                 {"a.yaml:2", "unknown key max_rnage"});
  spill(folder_ / "a.yaml", "max_range_m: 2000\n");
  expect_failure(detect("d.png", "camera.json", "--config " + (folder_ / "a.yaml")),
                 {"a.yaml", "max_range_m is 2000", "between"});
}

TEST_F(BadInput, FolderForPictures) {
  spill(folder_ / "file", "");
  expect_failure(detect("d.png", "camera.json", "--explain " + (folder_ / "file/out")),
                 {"file/out"});
}

// A plate before a wall that turns with nothing on it.
TEST_F(BadInput, EmptyTurntable) {
  io::BopSceneWriter writer(folder_ / "scan", "test", 1);
  const Camera camera{320, 240, 290, 290, 159.5, 119.5};
  const Pose camera_from_plate{rotation_from_vector({-2.2, 0, 0}), Eigen::Vector3d(0, 0.05, 0.75)};
  RandomStream random(1);
  for (int k = 0; k < 6; ++k) {
    Frame frame;
    frame.camera = camera;
    frame.depth = eval::render_depth(box(0.2f, 0.2f, 0.01f), camera_from_plate, camera);
    for (float& z : frame.depth) {
      z = (z > 0 ? z : 1.6f) + 0.001f * static_cast<float>(random.normal());
    }
    frame.color.assign(3 * frame.depth.size(), 128);
    ASSERT_TRUE(writer.add(k, frame, {}).ok());
  }
  ASSERT_TRUE(writer.finish().ok());
  expect_failure(
      "model from-scans " + (folder_ / "scan") + " --name x --library " + (folder_ / "S"),
      {"scan", "nothing stands on the turntable"});
}

TEST_F(BadInput, DataSets) {
  expect_failure("detect --library " + (folder_ / "L") + " --bop " + (folder_ / "none"),
                 {"none/test"});
  expect_failure("model from-bop " + (folder_ / "none") + " --library " + (folder_ / "X"),
                 {"models_info.json"});
  expect_failure("evaluate --bop " + (folder_ / "none") + " --csv x.csv", {"none/test"});
}

class Fusion : public BadInput {};

TEST_F(Fusion, SearchesFramesOfOneStillSceneOnce) {
  write_depth("d2.png", 160, 120, 702);
  write_depth("moved.png", 160, 120, 900);
  const auto fused = [&](const std::string& names) {
    std::string depths;
    for (const char* name : {"d.png", "d2.png"}) (depths += " ") += folder_ / name;
    if (!names.empty()) (depths += " ") += folder_ / names;
    const Outcome outcome =
        run("detect --library " + (folder_ / "L") + " --camera " + (folder_ / "camera.json") +
            " --fuse 3 --json " + (folder_ / "r.json") + " --depth" + depths);
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    const auto results = io::read_results_json(folder_ / "r.json");
    EXPECT_TRUE(results.ok() && results->size() == 1);
    const bool one = results.ok() && results->size() == 1;
    return std::pair(one ? results->front().fused_frames : 0, outcome.out);
  };
  EXPECT_EQ(fused("").first, 2);
  EXPECT_EQ(fused("d.png").first, 3);
  const auto [count, said] = fused("moved.png");
  EXPECT_EQ(count, 1);
  EXPECT_NE(said.find("moved.png: not combined with those before it: 100 % of the depths changed"),
            std::string::npos)
      << said;
}

TEST_F(Fusion, TakesTheImagesOfEachSceneOfADataSet) {
  for (const int scene : {1, 2}) {
    io::BopSceneWriter writer(folder_ / "set", "test", scene);
    for (int image = 0; image < 2 + scene; ++image) {
      ASSERT_TRUE(writer.add(image, box_frame(box_pose()), {}).ok());
    }
    ASSERT_TRUE(writer.finish().ok());
  }
  const Outcome outcome = run("detect --library " + (folder_ / "L") + " --bop " +
                              (folder_ / "set") + " --fuse 3 --json " + (folder_ / "r.json"));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  const auto results = io::read_results_json(folder_ / "r.json");
  ASSERT_TRUE(results.ok()) << results.status().message;
  std::vector<std::array<int, 3>> found;
  for (const io::FrameResult& frame : *results) {
    found.push_back({frame.scene_id, frame.im_id, frame.fused_frames});
  }
  EXPECT_EQ(found, (std::vector<std::array<int, 3>>{{1, 2, 3}, {2, 2, 3}, {2, 3, 1}}))
      << "of each three images the last, and what is left over at the end of a scene";
}

TEST(Usage, IsExitCodeTwo) {
  for (const char* arguments :
       {"", "teapot", "detect", "detect --library L", "detect --library L --pcd a --bop b",
        "detect --library L --depth a", "detect --library L --pcd a --fuse 0",
        "detect --library L --camera c --depth a b --color c", "detect --library L --pcd a --top 0",
        "detect --library L --pcd a --threads x", "model", "model from-mesh a", "evaluate --bop b",
        "evaluate --bop b --csv a --json c", "evaluate --csv a",
        "evaluate --bop b --nothing-there --csv a", "bench",
        "model list --library L --colour red"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.out;
    EXPECT_FALSE(outcome.out.empty());
  }
}

TEST(Usage, HelpIsExitCodeZeroEverywhere) {
  for (const char* command : {"", "model", "model from-mesh", "model from-bop", "model info",
                              "model list", "model remove", "detect", "evaluate", "bench speed"}) {
    const Outcome outcome = run(std::string(command) + " --help");
    EXPECT_EQ(outcome.code, 0) << command;
    if (std::string(command).empty() || std::string(command) == "model") continue;
    EXPECT_NE(outcome.out.find("--threads"), std::string::npos) << command;
    EXPECT_NE(outcome.out.find("--seed"), std::string::npos) << command;
  }
}

TEST(Commands, FromADataSetToFigures) {
  const test::TemporaryFolder folder;
  io::BopMesh model;
  model.obj_id = 4;
  model.name = "box";
  model.diameter = 0.23;
  model.mesh = box(0.06f, 0.04f, 0.09f);
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
    model.symmetry.discrete.push_back(
        {Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()), Eigen::Vector3d::Zero()});
  }
  ASSERT_TRUE(io::write_bop_models(folder / "set", {model}).ok());
  io::BopSceneWriter writer(folder / "set", "test", 3);
  io::BopInstanceRecord truth;
  truth.obj_id = 4;
  truth.camera_from_object = box_pose();
  ASSERT_TRUE(writer.add(9, box_frame(box_pose()), {truth}).ok());
  ASSERT_TRUE(writer.finish().ok());

  Outcome outcome = run("model from-bop " + (folder / "set") + " --library " + (folder / "L"));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  outcome = run("model list --library " + (folder / "L"));
  EXPECT_NE(outcome.out.find("3 discrete"), std::string::npos) << outcome.out;
  outcome = run("detect --library " + (folder / "L") + " --bop " + (folder / "set") +
                " --scenes 3 --csv " + (folder / "r.csv") + " --json " + (folder / "r.json") +
                " --annotate " + (folder / "pictures") + " --explain " + (folder / "why"));
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("scene 3 image 9"), std::string::npos) << outcome.out;
  const auto results = io::read_results_json(folder / "r.json");
  ASSERT_TRUE(results.ok()) << results.status().message;
  ASSERT_EQ(results->size(), 1u);
  EXPECT_EQ(results->at(0).im_id, 9);
  for (const char* picture :
       {"pictures/000003_000009.png", "pictures/contact_sheet.png", "pictures/worst_frames.png",
        "why/01_edges.png", "why/02_super_pixels.png", "why/03_sample.png", "why/14_select.png",
        "why/15_best.png"}) {
    EXPECT_TRUE(io::read_color_image(folder / picture).ok()) << picture;
  }
  EXPECT_NE(slurp(folder / "why/index.html").find("box in scene 3 image 9"), std::string::npos);
  for (const std::string& file : {"--csv " + (folder / "r.csv"), "--json " + (folder / "r.json")}) {
    outcome = run("evaluate --bop " + (folder / "set") + " " + file + " --plots " +
                  (folder / "plots") + " --json-out " + (folder / "e.json"));
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    EXPECT_NE(outcome.out.find("1 instances that count"), std::string::npos) << outcome.out;
  }
  EXPECT_FALSE(slurp(folder / "e.json").empty());
  outcome = run("evaluate --nothing-there --json " + (folder / "r.json"));
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("1 of them with 1 false positives"), std::string::npos) << outcome.out;
  outcome = run("alignment --bop " + (folder / "set") + " --library " + (folder / "L") +
                    " --starts 3 --iterations 5 --plots " + (folder / "alignment"),
                "bpa-experiments");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("1 placements, 3 trials"), std::string::npos) << outcome.out;
  EXPECT_NE(slurp(folder / "alignment/alignment.json").find("bpa_normals"), std::string::npos);
  EXPECT_TRUE(io::read_color_image(folder / "alignment/alignment_position.png").ok());
  outcome = run("model symmetry box --none --library " + (folder / "L"));
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  outcome = run("model info box --library " + (folder / "L"));
  EXPECT_NE(outcome.out.find("symmetries  none"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" cells of 3.0 mm"), std::string::npos) << outcome.out;
  outcome = run("model remove box --library " + (folder / "L"));
  EXPECT_EQ(outcome.code, 0) << outcome.out;
}

TEST(Experiments, SensorBesideAFrame) {
  EXPECT_EQ(run("sensor --sheet s.png", "bpa-experiments").code, 2);
  EXPECT_EQ(run("views --help", "bpa-experiments").code, 0);
  EXPECT_EQ(run("models --help", "bpa-experiments").code, 0);
  const test::TemporaryFolder folder;
  io::BopSceneWriter writer(folder / "set", "test", 3);
  ASSERT_TRUE(writer.add(9, box_frame(box_pose()), {}).ok());
  ASSERT_TRUE(writer.finish().ok());
  const Outcome outcome = run("sensor --bop " + (folder / "set") + " --sheet " +
                                  (folder / "sheet.png") + " --json " + (folder / "sensor.json"),
                              "bpa-experiments");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_TRUE(io::read_color_image(folder / "sheet.png").ok());
  EXPECT_NE(slurp(folder / "sensor.json").find("published_axial_m"), std::string::npos);
}

/// The library numbers its model otherwise than the data set.
TEST(Evaluate, ComparesTwoRunsByTheNamesOfModels) {
  const test::TemporaryFolder folder;
  io::BopMesh model{1, "box", 0.233, {}, box(0.06f, 0.04f, 0.09f)};
  ASSERT_TRUE(io::write_bop_models(folder.path(), {model}).ok());
  io::BopSceneWriter writer(folder.path(), "test", 1);
  io::BopInstanceRecord truth;
  truth.obj_id = truth.instance = 1;
  truth.camera_from_object = box_pose();
  Frame frame = box_frame(box_pose());
  for (const int image : {4, 5}) {
    frame.stamp_ns = image * 1'000'000'000LL;
    ASSERT_TRUE(writer.add(image, frame, {truth}).ok());
  }
  ASSERT_TRUE(writer.finish().ok());
  io::FrameResult result;
  result.scene_id = 1;
  result.im_id = 4;
  result.interpretations.resize(1);
  io::FrameResult other = result;
  other.im_id = 5;
  ASSERT_TRUE(io::write_results_json(folder / "a.json", {result, other}).ok());
  Placement placement;
  placement.model = "box";
  placement.model_number = 9;
  placement.frame_from_object = box_pose();
  placement.presence = placement.probability = 0.9;
  Placement wrong = placement;
  wrong.frame_from_object.translation.x() += 0.3;
  result.interpretations[0].placements = {placement, wrong};
  ASSERT_TRUE(io::write_results_json(folder / "b.json", {result}).ok());
  result.interpretations[0].placements = {placement};
  const std::string command = "evaluate --bop " + folder.path() + " ";
  const Outcome outcome = run(command + (folder / "a.json") + " " + (folder / "b.json"));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out,
            "scene 1 image 4: gained box; lost -\n"
            "scene 1 image 4: false positives gained box; lost -\n"
            "scene 1 image 5: not searched in " +
                (folder / "b.json") + "\n" + (folder / "a.json") +
                ": found 0/2, right of those reported 0/0\n" + (folder / "b.json") +
                ": found 1/2, right of those reported 1/2\n");
  EXPECT_EQ(run(command + (folder / "a.json")).code, 2);
  // A track of the same.
  io::TrackResult tracked;
  tracked.scene_id = 1;
  tracked.im_id = 4;
  Track track;
  track.id = 1;
  track.model = "box";
  track.model_number = 9;
  track.frame_from_object = box_pose();
  tracked.tracks = {track};
  ASSERT_TRUE(io::write_tracks_json(folder / "t.json", {tracked}).ok());
  const Outcome by_name = run(command + "--tracks " + (folder / "t.json"));
  EXPECT_EQ(by_name.code, 0) << by_name.out;
  tracked.tracks[0].model_number = 1;
  ASSERT_TRUE(io::write_tracks_json(folder / "t.json", {tracked}).ok());
  EXPECT_EQ(by_name.out, run(command + "--tracks " + (folder / "t.json")).out);
  // CSV has numbers alone: those of the data set.
  const std::string library = " --library " + (folder / "L");
  ASSERT_EQ(run("model from-mesh " + (folder / "models/obj_000001.ply") +
                " --unit mm --views 0 --name box --number 9" + library)
                .code,
            0);
  ASSERT_EQ(run("detect --bop " + folder.path() + library + " --csv " + (folder / "r.csv")).code,
            0);
  EXPECT_NE(slurp(folder / "r.csv").find("\n1,4,1,"), std::string::npos) << slurp(folder / "r.csv");
  result.interpretations[0].placements[0].model = "drill";
  ASSERT_TRUE(io::write_results_json(folder / "c.json", {result}).ok());
  expect_failure(command + "--json " + (folder / "c.json"), {"drill", "another library"});
  // A library of other models.
  ASSERT_EQ(run("model from-mesh " + (folder / "models/obj_000001.ply") +
                " --unit mm --views 0 --name mug --library " + (folder / "M"))
                .code,
            0);
  EXPECT_NE(run("track --bop " + folder.path() + " --library " + (folder / "M"))
                .out.find("the library lacks objects of its truth: box"),
            std::string::npos);
  // Depth that VSD needs and that cannot be read.
  const std::string depth = folder / "test/000001/depth/000005.png";
  spill(depth, slurp(depth).substr(0, 90));
  other.interpretations[0].placements = {placement};
  result.interpretations[0].placements[0].model = "box";
  ASSERT_TRUE(io::write_results_json(folder / "d.json", {result, other}).ok());
  const Outcome partly = run(command + "--json " + (folder / "d.json"));
  EXPECT_EQ(partly.code, 1) << partly.out;
  EXPECT_NE(partly.out.find("1 of 2 frames could not be evaluated"), std::string::npos);
  EXPECT_NE(partly.out.find("1 frames, 1 instances that count"), std::string::npos) << partly.out;
}

}  // namespace
}  // namespace bpa
