// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench speed on a frame of an L and a brick.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "core/io/model_file.hpp"
#include "tests/support/posed_models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command.hpp"

namespace bpa::cli {
namespace {

using Json = nlohmann::ordered_json;

class BenchSpeed : public ::testing::Test {
 protected:
  void SetUp() override {
    const Pose camera_from_world = test::look_at({0.1, -0.6, 0.5}, {0, 0, 0});
    const Pose l_truth = camera_from_world * test::standing_at(-0.08, 0, 0.02, 0.7);
    const auto solids = test::together({test::table(camera_from_world)}, test::l_solids(l_truth));
    io::BopSceneWriter writer(folder_ / "set", "test", 1);
    const Frame frame = test::render(solids, test::kinect_camera(), 1, 8).frame;
    ASSERT_TRUE(writer.add(0, frame, {{1, l_truth, {}, {}, 1}}).ok());
    ASSERT_TRUE(writer.finish().ok());
    save(test::l_mesh(), "l", 1);
    save(test::box_mesh(test::kBrickHalf), "brick", 2);
  }
  void save(const TriangleMesh& mesh, const std::string& name, int number) const {
    const auto source = modeling::model_source_from_mesh(mesh, name, number);
    ASSERT_TRUE(source.ok()) << source.status().message;
    ASSERT_TRUE(io::save_model(folder_ / "library", *source).ok());
  }

  struct Run {
    int exit_code;
    std::string out, error;
  };
  Run run(std::vector<std::string> options) const {
    options.insert(options.begin(), {"bpa", "bench", "speed", "--bop", folder_ / "set", "--library",
                                     folder_ / "library"});
    std::vector<char*> arguments;
    for (std::string& option : options) arguments.push_back(option.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_bpa(static_cast<int>(arguments.size()), arguments.data());
    const std::string out = testing::internal::GetCapturedStdout();
    return {code, out, testing::internal::GetCapturedStderr()};
  }
  Json report(const std::string& name) const { return Json::parse(test::slurp(folder_ / name)); }

  const test::TemporaryFolder folder_;
};

TEST_F(BenchSpeed, ReportsWhatIsFoundAndWhatItCosts) {
  const Run done = run({"--budgets", "0.000001,0", "--model-counts", "1,2,50", "--threads", "2",
                        "--json", folder_ / "r.json", "--plot", folder_ / "r.png"});
  ASSERT_EQ(done.exit_code, 0) << done.error;
  EXPECT_NE(done.out.find("The library has 2 models; no more are searched for. --shapes DIR adds "
                          "some."),
            std::string::npos);
  const Json json = report("r.json");
  EXPECT_EQ(json.at("format"), "bpa speed bench");
  EXPECT_EQ(json.at("version"), 1);
  EXPECT_EQ(json.at("dataset"), "set");
  EXPECT_EQ(json.at("threads"), 2);
  EXPECT_EQ(json.at("frames"), 1);
  EXPECT_FALSE(json.at("cpu").get<std::string>().empty());
  ASSERT_EQ(json.at("budgets").size(), 2u);
  const Json &hurried = json.at("budgets").at(0), &whole = json.at("budgets").at(1);
  EXPECT_EQ(hurried.at("found"), 0);
  EXPECT_TRUE(whole.at("budget_s").is_null());
  EXPECT_EQ(whole.at("found"), 1);
  EXPECT_EQ(whole.at("found_in_twenty"), 1);
  EXPECT_EQ(whole.at("instances"), 1);
  EXPECT_GE(whole.at("reported"), 1);
  EXPECT_EQ(whole.at("right"), 1);
  for (const char* cost : {"median_ms", "max_ms", "cpu_s", "rounds", "full_scores"}) {
    EXPECT_GT(whole.at(cost), 0) << cost;
  }
  ASSERT_EQ(json.at("models").size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const Json& row = json.at("models").at(i);
    EXPECT_EQ(row.at("models"), i + 1);
    EXPECT_EQ(row.at("loaded"), i + 1);
    EXPECT_GT(row.at("load_ms"), 0);
    EXPECT_EQ(row.at("found"), 1) << "the model of the truth is always searched for";
  }
  EXPECT_GT(json.at("models").at(1).at("pose_checks"), json.at("models").at(0).at("pose_checks"));
  EXPECT_TRUE(json.at("stages_ms").contains("objects: sample"));
  EXPECT_EQ(json.at("stages_ms").back(), json.at("stages_ms").at("total"));
  EXPECT_TRUE(io::read_color_image(folder_ / "r.png").ok());
}

TEST_F(BenchSpeed, FillsUpALibraryWithMadeShapes) {
  const std::vector<std::string> options = {
      "--budgets",        "0",      "--model-counts",  "2,4", "--shapes",
      folder_ / "shapes", "--json", folder_ / "r.json"};
  const Run first = run(options);
  ASSERT_EQ(first.exit_code, 0) << first.error;
  EXPECT_EQ(io::list_models(folder_ / "shapes"), (std::vector<std::string>{"bowl_1", "mug_1"}));
  const Json made = report("r.json");
  ASSERT_EQ(made.at("models").size(), 2u);
  const Json& row = made.at("models").at(1);
  EXPECT_EQ(row.at("models"), 4);
  EXPECT_EQ(row.at("loaded"), 4);
  EXPECT_EQ(row.at("found"), 1);
  EXPECT_EQ(row.at("found_when_given"), 1);
  EXPECT_GT(row.at("sampled_poses"), made.at("models").at(0).at("sampled_poses"));
  EXPECT_EQ(made.at("budgets").at(0).at("pose_checks"), made.at("models").at(0).at("pose_checks"))
      << "budgets are measured with the library alone";

  // What is there already is not made again, and what it lacks is.
  const std::string kept = folder_ / "shapes/mug_1/model.json";
  const auto written = std::filesystem::last_write_time(kept);
  std::filesystem::remove_all(folder_ / "shapes/bowl_1");
  ASSERT_EQ(run(options).exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(kept), written);
  EXPECT_EQ(report("r.json").at("models").at(1).at("pose_checks"), row.at("pose_checks"));
}

TEST_F(BenchSpeed, SaysWhatIsWrong) {
  const auto refusal = [&](const std::vector<std::string>& options) {
    const Run failed = run(options);
    EXPECT_EQ(failed.exit_code, 1);
    return failed.error;
  };
  EXPECT_EQ(run({"--budgets", "-1"}).exit_code, 2);
  EXPECT_EQ(run({"--model-counts", "0"}).exit_code, 2);
  EXPECT_NE(refusal({"--scenes", "7"}).find("has no scene 7"), std::string::npos);
  EXPECT_EQ(refusal({"--shapes", folder_ / "library"}),
            "bpa: --shapes is the library itself; it must be another folder\n");
  std::filesystem::remove_all(folder_ / "library");
  EXPECT_NE(refusal({}).find("library is not there"), std::string::npos) << refusal({});
}

}  // namespace
}  // namespace bpa::cli
