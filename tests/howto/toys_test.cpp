// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Each toy of the patches beside this file is in what a detection reports. Built in a copy of the
// tree that has them (CMakeLists.txt).
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/cli/convert.hpp"
#include "client/src/convert.hpp"
#include "core/detect/stages.hpp"
#include "core/io/results.hpp"
#include "core/pipeline/detector.hpp"
#include "core/sim/sensor.hpp"
#include "idl/wire/cdr.hpp"
#include "server/convert/results.hpp"
#include "tests/support/l_scene.hpp"

namespace bpa {
namespace {

using Json = nlohmann::json;

class Toys : public test::LScene {
 protected:
  // What a detection that takes the frame for the toy's finds.
  static void SetUpTestSuite() {
    LScene::SetUpTestSuite();
    auto library = std::make_shared<ModelLibrary>();
    ASSERT_TRUE(library->add(l_).ok() && library->add(brick_).ok());
    DetectorOptions options;
    options.surface.sensor = "toy";
    ASSERT_TRUE(validate(options).ok());
    const Frame frame = test::render(everything(), test::kinect_camera(), 1, 8).frame;
    auto found = Detector(library, options).detect(frame, {}, &trace_);
    ASSERT_TRUE(found.ok()) << found.status().message;
    result_ = *std::move(found);
    ASSERT_FALSE(result_.interpretations.front().placements.empty());
  }
  static const Placement& placement() { return result_.interpretations.front().placements.front(); }
  static io::FrameResult in_file() {
    io::FrameResult result;
    static_cast<SceneInterpretations&>(result) = result_;
    return result;
  }
  static Json first_in(const io::FrameResult& result) {
    return Json::parse(io::result_json_line(result))["interpretations"][0]["placements"][0];
  }

  static inline FrameTrace trace_;
  static inline SceneInterpretations result_;
};

TEST_F(Toys, StageIsInTheTraceBehindTheOneBefore) {
  const auto& stages = trace_.objects.front().stages;
  const auto toy = std::ranges::find(stages, "toy", &detect::TraceStage::name);
  ASSERT_NE(toy, stages.end());
  EXPECT_EQ(std::prev(toy)->name, "correct");
  EXPECT_FALSE(toy->poses.empty());
  EXPECT_EQ(detect::scoring_stages().front().name, "refine");
  EXPECT_EQ(detect::final_stages().front().name, "climb");
}

TEST_F(Toys, SourceSuggestsPosesThatGoThroughAllStages) {
  const SceneFeatures scene = features_of(everything(), 1);
  const detect::Search search(scene, *brick_);
  detect::Candidates toys = sample(search, {});
  std::erase_if(toys, [](const detect::Candidate& c) { return c.found_by != detect::Source::toy; });
  EXPECT_EQ(toys.size(), 20U);
  toys.push_back(
      {.model = brick_.get(), .refinement = {brick_truth_}, .found_by = detect::Source::toy});
  std::vector<detect::Search> searches{search};
  std::vector<detect::Candidates> found{toys};
  detect::run_stages(detect::detection_stages().subspan(1), searches, 1, found);
  ASSERT_FALSE(found.front().empty());
  EXPECT_EQ(found.front().front().found_by, detect::Source::toy);
}

TEST_F(Toys, ComponentIsInTheResult) {
  const Json components = first_in(in_file()).at("components");
  EXPECT_NEAR(components.at("toy").get<double>(), placement().frame_from_object.translation.norm(),
              1e-12);
}

TEST_F(Toys, SensorIsSimulatedToldFromItsFrameAndNamed) {
  EXPECT_EQ(result_.sensor, "toy");
  EXPECT_EQ(noise_of(SensorKind::toy)(1), trace_.scene.map.noise(2));
  TriangleMesh wall;
  wall.vertices = {{-9, -9, 1}, {9, -9, 1.2f}, {9, 9, 1}, {-9, 9, 1.2f}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<const TriangleMesh*> meshes{&wall};
  const sim::RayMeshes prepared(meshes);
  const std::vector<sim::PosedMesh> posed{{0, Pose{}}};
  const sim::RayScene scene(prepared, posed);
  sim::Shading shading;
  shading.materials.resize(1);
  sim::SensorOptions options;
  options.kind = SensorKind::toy;
  const Frame frame =
      simulate_sensor({scene, shading, {320, 240, 300, 300, 159.5, 119.5}, Pose{}}, options, 5)
          .frame;
  EXPECT_EQ(name_of(sensor_kind_of(sensor_traits(frame))), "toy");
}

TEST_F(Toys, FieldIsInFilesOverTheWireAndInTheSdk) {
  const double expected = placement().frame_from_object.translation.norm();
  EXPECT_EQ(first_in(in_file()).at("toy"), expected);
  const auto sent = server::interpretations_message(result_, {5, "cam", 2, 0});
  std::vector<std::uint8_t> bytes(wire::encoded_size(sent));
  wire::encode(sent, bytes.data(), bytes.size());
  wire::bpa_msgs::SceneInterpretations got;
  ASSERT_TRUE(wire::decode(bytes.data(), bytes.size(), got).ok());
  const DetectionSet set = sdk::to_detections(got);
  EXPECT_EQ(set.best().front().toy, expected);
  EXPECT_EQ(first_in(cli::to_frame_result(set)).at("toy"), expected);
}

}  // namespace
}  // namespace bpa
