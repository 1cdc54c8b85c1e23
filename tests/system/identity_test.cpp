// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "client/cli/convert.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "core/pipeline/detector.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/service.hpp"
#include "server/convert/results.hpp"
#include "tests/support/box_frame.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"

// The same frame, library and seed through bpa-server and through the detector itself: the same
// interpretations, bit for bit, for 1 and 2 threads.

namespace bpa {
namespace {

namespace fs = std::filesystem;
namespace msgs = wire::bpa_msgs;
using std::chrono::milliseconds;

PosePrior prior_of(const ExpectedPose& expected) {
  PosePrior prior;
  prior.model = expected.model;
  const auto& p = expected.camera_from_object.position;
  prior.position = PositionPrior{
      {p[0], p[1], p[2]}, Eigen::Map<const Eigen::Matrix3d>(expected.position_covariance.data())};
  for (int axis = 0; axis < 3; ++axis) {
    const auto& from = expected.orientation_spread.axes[static_cast<std::size_t>(axis)];
    prior.orientation.axes.col(axis) = Eigen::Map<const Eigen::Vector4d>(from.data());
  }
  prior.orientation.concentrations =
      Eigen::Map<const Eigen::Vector3d>(expected.orientation_spread.concentrations.data());
  prior.weight = expected.weight;
  return prior;
}

/// A request with a region, a mask, models, a budget and a prior, through the SDK.
void expect_same_question(const Detector& detector, Frame frame, std::uint64_t seed) {
  const Camera& camera = frame.camera;
  frame.roi = {camera.width / 8, camera.height / 8, 3 * camera.width / 4, 3 * camera.height / 4};
  frame.mask.assign(frame.depth.size(), 1);
  std::fill_n(frame.mask.begin(), frame.mask.size() / 4, std::uint8_t{0});
  DetectQuery query;
  query.models = {detector.library().models().front()->name};
  query.budget_ms = 1e6;
  query.seed = seed;
  query.top_k = 7;
  query.priors = {
      expected_pose(query.models[0], {{{0.0, 0.0, 0.58}}, {{0.6, 0, 0, 0.8}}}, 0.05, 0.5, 0.9)};
  DetectRequest request;
  request.models = query.models;
  request.budget_ms = query.budget_ms;
  request.seed = query.seed;
  request.top_k = query.top_k;
  request.priors = {prior_of(query.priors[0])};
  const auto expected = detector.detect(frame, request);
  ASSERT_TRUE(expected.ok()) << expected.status().message;

  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto found = client->detect_in(cli::view_of(frame), query, milliseconds(90000));
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_EQ(found->models_searched, 1);
  EXPECT_FALSE(found->budget_exhausted);
  ASSERT_EQ(found->interpretations.size(), expected->interpretations.size());
  for (std::size_t k = 0; k < found->interpretations.size(); ++k) {
    const auto& detections = found->interpretations[k].detections;
    const auto& placements = expected->interpretations[k].placements;
    ASSERT_EQ(detections.size(), placements.size());
    for (std::size_t i = 0; i < detections.size(); ++i) {
      EXPECT_EQ(detections[i].probability, placements[i].probability);
      EXPECT_EQ(detections[i].camera_from_object.position[0],
                placements[i].frame_from_object.translation.x());
      EXPECT_EQ(detections[i].score_parts.back().name, "prior");
    }
  }
  query.budget_ms = 1e-3;
  const auto hurried = client->detect_in(cli::view_of(frame), query, milliseconds(90000));
  ASSERT_TRUE(hurried.ok()) << hurried.status().message;
  EXPECT_TRUE(hurried->budget_exhausted);
  query.priors[0].model = "teapot";
  EXPECT_EQ(client->detect_in(cli::view_of(frame), query, milliseconds(90000)).status().code,
            StatusCode::not_found);
  query.priors[0].weight = 0;
  EXPECT_EQ(client->detect_in(cli::view_of(frame), query).status().code,
            StatusCode::invalid_argument);
}

/// Detects `frame` with the library both ways.
void expect_identity(const std::string& folder, const Frame& frame) {
  constexpr std::uint64_t kSeed = 5;
  auto sources = io::load_library(folder);
  ASSERT_TRUE(sources.ok()) << sources.status().message;
  auto library = std::make_shared<ModelLibrary>();
  for (ModelSource& source : *sources) {
    auto model = make_object_model(std::move(source));
    ASSERT_TRUE(model.ok()) << model.status().message;
    ASSERT_TRUE(library->add(*model).ok());
  }
  const Detector detector(library, DetectorOptions());
  DetectRequest request;
  request.seed = kSeed;
  request.num_threads = 1;
  const auto offline = detector.detect(frame, request);
  ASSERT_TRUE(offline.ok()) << offline.status().message;
  const auto expected = support::bits(server::interpretations_message(
      offline, {frame.stamp_ns, frame.frame_id, library->size(), kSeed}));

  for (const char* threads : {"1", "2"}) {
    const std::string log = support::scratch_folder() + "/identity.log";
    const support::Process server(
        support::own_command("bpa-server", {"--library", folder, "--threads", threads}), log);
    auto participant = support::test_participant("tester");
    ASSERT_TRUE(participant.ok()) << participant.status().message;
    auto detect = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
    ASSERT_TRUE(detect.ok());
    msgs::Detect_Request call;
    call.has_frame = true;
    call.frame = support::message_of(frame);
    call.seed = kSeed;
    const auto reply = detect->call(call, milliseconds(90000));
    ASSERT_TRUE(reply.ok()) << reply.status().message << support::read_text(log);
    ASSERT_TRUE(reply->success) << reply->status.message;
    EXPECT_EQ(reply->result.interpretations.size(), offline->interpretations.size());
    EXPECT_TRUE(support::bits(reply->result) == expected) << "with " << threads << " threads";
    if (threads == std::string("2")) expect_same_question(detector, frame, kSeed);
  }
}

// A library with a broken model serves the others, says which one is broken, and takes it when it
// has been mended.
TEST(Library, OneBrokenModelCostsNoOther) {
  const std::string folder = support::scratch_folder() + "/broken_library";
  int number = 0;
  for (const char* name : {"good", "bad"}) {
    const auto source = modeling::model_source_from_mesh(support::stepped_box(), name, ++number);
    ASSERT_TRUE(source.ok());
    ASSERT_TRUE(io::save_model(folder, *source).ok());
  }
  const std::string surface = support::read_text(folder + "/bad/surface.ply");
  std::filesystem::resize_file(folder + "/bad/surface.ply", surface.size() / 2);
  const std::string log = support::scratch_folder() + "/broken.log";
  const support::Process server(support::own_command("bpa-server", {"--library", folder}), log);
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto list = wire::ServiceClient<msgs::ListModels>::create(*participant, "list_models");
  auto load = wire::ServiceClient<msgs::LoadModel>::create(*participant, "load_model");
  ASSERT_TRUE(list.ok() && load.ok());
  const auto reply = list->call({}, milliseconds(30000));
  ASSERT_TRUE(reply.ok()) << reply.status().message << support::read_text(log);
  EXPECT_TRUE(reply->success);
  ASSERT_EQ(reply->models.size(), 1U);
  EXPECT_EQ(reply->models[0].name, "good");
  EXPECT_EQ(reply->status.code, static_cast<std::uint8_t>(StatusCode::corrupt));
  for (const char* words : {"bad (", "truncated"}) {
    EXPECT_NE(reply->status.message.find(words), std::string::npos) << reply->status.message;
    EXPECT_NE(support::read_text(log).find(words), std::string::npos);
  }
  msgs::ListModels_Request one;
  one.names = {"bad"};
  const auto asked = list->call(one, milliseconds(30000));
  ASSERT_TRUE(asked.ok());
  EXPECT_FALSE(asked->success);
  EXPECT_NE(asked->status.message.find("truncated"), std::string::npos) << asked->status.message;

  std::ofstream(folder + "/bad/surface.ply", std::ios::binary) << surface;
  msgs::LoadModel_Request mended;
  mended.source = "bad";
  const auto loaded = load->call(mended, milliseconds(30000));
  ASSERT_TRUE(loaded.ok());
  EXPECT_TRUE(loaded->success) << loaded->status.message;
  const auto again = list->call({}, milliseconds(30000));
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->models.size(), 2U);
  EXPECT_EQ(again->status.message, "");
}

TEST(Identity, OfASyntheticFrame) {
  const std::string folder = support::scratch_folder() + "/library";
  const auto model = modeling::model_source_from_mesh(support::stepped_box(), "step", 4);
  ASSERT_TRUE(model.ok()) << model.status().message;
  ASSERT_TRUE(io::save_model(folder, *model).ok());
  expect_identity(folder, support::box_frame());
}

TEST(Identity, OfARealFrame) {
  const char* named = std::getenv("BPA_DATA");
  const std::string data =
      (named != nullptr ? std::string(named) : BPA_SOURCE_DIR "/../shared/data") + "/ycbv";
  if (!fs::exists(data + "/models")) GTEST_SKIP() << data << " is not there";
  const auto models = io::read_bop_models(data);
  const auto frames = io::read_bop_frames(data, "test");
  ASSERT_TRUE(models.ok() && frames.ok());
  const auto frame = io::load_bop_frame(frames->front());
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  const std::string folder = support::scratch_folder() + "/ycbv_library";
  for (std::size_t i = 0; i < 2 && i < frames->front().truth.size(); ++i) {
    for (const io::BopModel& model : *models) {
      if (model.obj_id != frames->front().truth[i].obj_id) continue;
      const auto mesh = io::read_mesh(model.path, 0.001);
      ASSERT_TRUE(mesh.ok()) << mesh.status().message;
      const auto source = modeling::model_source_from_mesh(*mesh, model.name, model.obj_id);
      ASSERT_TRUE(source.ok()) << source.status().message;
      ASSERT_TRUE(io::save_model(folder, *source).ok());
    }
  }
  expect_identity(folder, *frame);
}

}  // namespace
}  // namespace bpa
