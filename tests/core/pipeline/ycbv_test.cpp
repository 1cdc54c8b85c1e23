// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gtest/gtest.h>

#include "core/io/bop_dataset.hpp"
#include "core/io/mesh_file.hpp"
#include "core/modeling/model_source.hpp"
#include "core/pipeline/detector.hpp"
#include "tests/support/temporary_folder.hpp"

// A guard against regressions on a real frame, with wide margins; accuracy is measured elsewhere.

namespace bpa {
namespace {

std::shared_ptr<const ModelLibrary> library_of(const std::string& dataset,
                                               const io::BopFrame& frame) {
  auto library = std::make_shared<ModelLibrary>();
  const auto models = io::read_bop_models(dataset);
  EXPECT_TRUE(models.ok()) << models.status().message;
  for (const io::BopModel& info : *models) {
    const bool there = std::any_of(frame.truth.begin(), frame.truth.end(),
                                   [&](const auto& truth) { return truth.obj_id == info.obj_id; });
    if (!there) continue;
    const auto mesh = io::read_mesh(info.path, 0.001);
    EXPECT_TRUE(mesh.ok()) << mesh.status().message;
    auto source = modeling::model_source_from_mesh(*mesh, info.name, info.obj_id);
    EXPECT_TRUE(source.ok()) << source.status().message;
    EXPECT_NEAR(source->diameter, info.diameter, 0.03 * info.diameter) << info.name;
    source->symmetry = info.symmetry;
    const auto model = make_object_model(std::move(source).value());
    EXPECT_TRUE(model.ok() && library->add(*model).ok());
  }
  return library;
}

int right_placements(const Interpretation& interpretation, const io::BopFrame& frame,
                     const ModelLibrary& library) {
  int right = 0;
  for (const io::BopInstance& truth : frame.truth) {
    right += std::any_of(interpretation.placements.begin(), interpretation.placements.end(),
                         [&](const Placement& placement) {
                           const PoseError error =
                               pose_error(placement.frame_from_object, truth.camera_from_object,
                                          library.find(placement.model)->symmetry);
                           return placement.model_number == truth.obj_id &&
                                  error.position < 0.025 && error.angle < M_PI / 16;
                         });
  }
  return right;
}

TEST(Ycbv, ObjectsOfARealFrameAreFoundWhateverTheThreads) {
  const std::string data = test::real_data();
  if (data.empty()) GTEST_SKIP() << "no real frames here; BPA_DATA names their folder";
  const std::string dataset = data + "/ycbv";
  const auto frames = io::read_bop_frames(dataset, "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  const io::BopFrame& chosen = frames->front();
  const auto library = library_of(dataset, chosen);
  ASSERT_GE(library->size(), 3);
  const auto frame = io::load_bop_frame(chosen);
  ASSERT_TRUE(frame.ok()) << frame.status().message;

  const Detector detector(library, {});
  DetectRequest request;
  request.num_threads = 1;
  const auto one = detector.detect(*frame, request);
  ASSERT_TRUE(one.ok()) << one.status().message;
  EXPECT_GE(right_placements(one->interpretations[0], chosen, *library), 2);

  request.num_threads = 2;
  const auto two = detector.detect(*frame, request);
  ASSERT_TRUE(two.ok());
  ASSERT_EQ(one->interpretations.size(), two->interpretations.size());
  for (std::size_t k = 0; k < one->interpretations.size(); ++k) {
    const auto& a = one->interpretations[k].placements;
    const auto& b = two->interpretations[k].placements;
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(one->interpretations[k].score, two->interpretations[k].score);
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].model, b[i].model);
      EXPECT_EQ(a[i].frame_from_object.translation, b[i].frame_from_object.translation);
      EXPECT_EQ(a[i].frame_from_object.rotation.coeffs(), b[i].frame_from_object.rotation.coeffs());
    }
  }
}

// An OBJ with a texture image, as people have them. Its origin is the scanner's; its axes are those
// of YCB-Video. By shape alone a box upside down is as good.
TEST(Ycbv, ATexturedMeshIsFoundTheRightWayRound) {
  const std::string data = test::real_data();
  if (data.empty()) GTEST_SKIP() << "no real frames here; BPA_DATA names their folder";
  const auto mesh = io::read_mesh_file(data + "/textured/cracker_box/textured.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.status().message;
  constexpr int kCrackerBox = 2;
  auto source = modeling::model_source_from_mesh(mesh->mesh, "cracker_box", kCrackerBox);
  ASSERT_TRUE(source.ok()) << source.status().message;
  auto library = std::make_shared<ModelLibrary>();
  ASSERT_TRUE(library->add(make_object_model(std::move(source).value()).value()).ok());

  const auto frames = io::read_bop_frames(data + "/ycbv", "test");
  ASSERT_TRUE(frames.ok()) << frames.status().message;
  int there = 0;
  for (const io::BopFrame& frame : *frames) {
    const auto truth = std::ranges::find(frame.truth, kCrackerBox, &io::BopInstance::obj_id);
    if (truth == frame.truth.end()) continue;
    ++there;
    const auto found = Detector(library, {}).detect(io::load_bop_frame(frame).value());
    ASSERT_TRUE(found.ok()) << found.status().message;
    const auto& best = found->interpretations.at(0).placements;
    ASSERT_EQ(best.size(), 1u);
    EXPECT_LT(
        rotation_angle(best[0].frame_from_object.rotation, truth->camera_from_object.rotation),
        0.1);
  }
  EXPECT_GE(there, 2);
}

}  // namespace
}  // namespace bpa
