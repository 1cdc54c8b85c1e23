// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "idl/wire/status.hpp"
#include "server/group/claims.hpp"
#include "server/group/library.hpp"
#include "server/group/messages.hpp"
#include "server/group/split.hpp"
#include "tests/support/box_frame.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::server::group {
namespace {

namespace fs = std::filesystem;
namespace msgs = wire::bpa_msgs;

// All ways to split a few models over a few workers, and the best of them.
TEST(Split, SlowestShareIsAsShortAsAnySplitMakesIt) {
  const std::vector<double> pace = {100, 150, 400};
  constexpr std::size_t kModels = 6;
  double best_ms = std::numeric_limits<double>::infinity();
  const auto slowest_ms = [&](const std::vector<std::size_t>& worker_of) {
    std::vector<double> busy_ms(pace.size(), 0);
    for (const std::size_t worker : worker_of) busy_ms[worker] += pace[worker];
    return *std::ranges::max_element(busy_ms);
  };
  std::vector<std::size_t> worker_of(kModels, 0);
  for (int code = 0; code < 729; ++code) {  // 3 workers, 6 models
    for (int rest = code; std::size_t & worker : worker_of) {
      worker = static_cast<std::size_t>(rest % 3);
      rest /= 3;
    }
    best_ms = std::min(best_ms, slowest_ms(worker_of));
  }
  EXPECT_EQ(slowest_ms(split_models(kModels, pace)), best_ms);
}

TEST(Split, OneFrameGetsAllWorkersManyFramesOneEach) {
  EXPECT_EQ(workers_for_frame(1, 4), 4U);
  EXPECT_EQ(workers_for_frame(2, 4), 2U);
  EXPECT_EQ(workers_for_frame(8, 4), 1U);
  EXPECT_EQ(workers_for_frame(1, 0), 1U);
  EXPECT_EQ(workers_for_frame(0, 3), 3U);
}

TEST(Claims, ExactlyOneOfThoseThatHearOneAnotherServes) {
  const FrontClaim weak{1, "weak", 0, true}, strong{2, "strong", 5, false};
  // The weaker one serves until the stronger does.
  EXPECT_TRUE(is_to_serve(weak, {strong}));
  EXPECT_TRUE(is_to_serve(strong, {weak}));
  EXPECT_FALSE(is_to_serve(weak, {{2, "strong", 5, true}}));
  // Of equals: the one that serves; of two that serve, or of two that wait, the smaller number.
  for (const bool both_serve : {false, true}) {
    const FrontClaim first{1, "first", 0, both_serve}, second{2, "second", 0, both_serve};
    EXPECT_TRUE(is_to_serve(first, {second}));
    EXPECT_FALSE(is_to_serve(second, {first}));
  }
  EXPECT_FALSE(is_to_serve({1, "new", 0, false}, {{2, "old", 0, true}}));
  EXPECT_TRUE(is_to_serve({2, "old", 0, true}, {{1, "new", 0, false}}));
  EXPECT_TRUE(is_to_serve({1, "alone", -3, false}, {}));
}

class GroupLibrary : public testing::Test {
 protected:
  GroupLibrary() {
    int number = 0;
    for (const char* name : {"brick", "plate"}) {
      const Eigen::Vector3f half(0.03f, 0.02f + 0.01f * static_cast<float>(number), 0.0125f);
      auto source = modeling::model_source_from_mesh(test::box_mesh(half), name, ++number);
      EXPECT_TRUE(source.ok()) << source.status().message;
      EXPECT_TRUE(io::save_model(at_front(), *source).ok());
    }
  }

  std::string at_front() const { return folder_.path() + "/front"; }
  std::string at_worker() const { return folder_.path() + "/worker"; }

  std::shared_ptr<const SharedLibrary> front_library() const {
    ModelLibrary models;
    std::map<std::string, std::string> folders;
    auto sources = io::load_library(at_front());
    EXPECT_TRUE(sources.ok()) << sources.status().message;
    for (ModelSource& source : *sources) {
      folders[source.name] = at_front() + "/" + source.name;
      auto model = make_object_model(std::move(source));
      EXPECT_TRUE(model.ok() && models.add(*model).ok());
    }
    auto shared =
        share_library(std::move(models), score::default_score_layers(), std::move(folders));
    EXPECT_TRUE(shared.ok()) << shared.status().message;
    return *shared;
  }

  /// A worker that fetches from `front`, and counts its calls.
  Result<std::shared_ptr<const SharedLibrary>> fetch(const SharedLibrary& front,
                                                     const SharedLibrary* before = nullptr) {
    const ModelCache cache(at_worker());
    return load_library(
        front.offer, before, cache,
        [&](const msgs::GetModelFile_Request& request) -> Result<msgs::GetModelFile_Response> {
          ++calls_;
          msgs::GetModelFile_Response response = read_model_file(front, request);
          if (response.success) return response;
          return wire::to_status(response.status);
        },
        1);
  }

  test::TemporaryFolder folder_;
  int calls_ = 0;
};

TEST_F(GroupLibrary, WorkerFetchesEachVersionOnce) {
  const auto front = front_library();
  const auto first = fetch(*front);
  ASSERT_TRUE(first.ok()) << first.status().message;
  EXPECT_EQ((*first)->offer.digest, front->offer.digest);
  ASSERT_EQ((*first)->models.size(), 2);
  const auto& fetched = *(*first)->models.models()[1];
  const auto& own = *front->models.models()[1];
  EXPECT_EQ(fetched.name, own.name);
  EXPECT_EQ(fetched.number, own.number);
  ASSERT_EQ(fetched.surface.size(), own.surface.size());
  for (std::size_t i = 0; i < own.surface.size(); ++i) {
    EXPECT_EQ(fetched.surface.points[i], own.surface.points[i]);
  }
  EXPECT_GT(calls_, 0);

  calls_ = 0;
  ASSERT_TRUE(fetch(*front).ok());  // after a new start: from the cache
  EXPECT_EQ(calls_, 0);

  // One model changes: the other one is the same object, in memory too.
  auto source = modeling::model_source_from_mesh(test::box_mesh({0.03f, 0.03f, 0.03f}), "plate", 2);
  ASSERT_TRUE(source.ok() && io::save_model(at_front(), *source).ok());
  const auto changed = front_library();
  EXPECT_NE(changed->offer.digest, front->offer.digest);
  const auto second = fetch(*changed, first->get());
  ASSERT_TRUE(second.ok()) << second.status().message;
  EXPECT_GT(calls_, 0);
  EXPECT_EQ((*second)->find(1), (*first)->find(1));
  EXPECT_NE((*second)->find(2), (*first)->find(2));
}

TEST_F(GroupLibrary, WhatChangedOnTheFrontsDiskIsRefused) {
  const auto front = front_library();
  std::ofstream(at_front() + "/brick/model.json", std::ios::app) << "\n";
  const auto fetched = fetch(*front);
  EXPECT_EQ(fetched.status().code, StatusCode::corrupt);
  EXPECT_NE(fetched.status().message.find("load it again"), std::string::npos)
      << fetched.status().message;
}

TEST_F(GroupLibrary, NamesFromTheWireDoNotLeaveTheCache) {
  const ModelCache cache(at_worker());
  const auto never = [](const msgs::GetModelFile_Request&) {
    ADD_FAILURE() << "fetched";
    return Result<msgs::GetModelFile_Response>(msgs::GetModelFile_Response());
  };
  msgs::GroupModel model;
  model.name = "brick";
  model.number = 1;
  model.stored_name = "../brick";
  model.digest = "0123456789abcdef";
  EXPECT_EQ(cache.folder_of(model, never).status().code, StatusCode::invalid_argument);
  model.stored_name = "brick";
  model.digest = "../../../etc/pas";
  EXPECT_EQ(cache.folder_of(model, never).status().code, StatusCode::invalid_argument);
}

TEST_F(GroupLibrary, TaskReachesTheWorkerToTheBitOrIsRefused) {
  const auto front = front_library();
  Frame frame = support::box_frame();
  frame.depth[7] = 0;
  frame.roi = {3, 4, 100, 90};
  frame.mask.assign(frame.depth.size(), 1);
  frame.background.assign(frame.depth.size(), 0);
  DetectRequest request;
  request.seed = std::numeric_limits<std::uint64_t>::max();
  PosePrior prior;
  prior.model = "plate";
  prior.position = PositionPrior{{0.1, 0.2, 1.0 / 3}, 1e-4 * Eigen::Matrix3d::Identity()};
  request.priors = {prior};
  const Pose pose{Eigen::Quaterniond(0.1, 0.7, -0.3, 0.2).normalized(), {0.1, 1.0 / 3, 0.7}};
  request.expected = {{"brick", pose}};
  DetectorOptions options;
  options.detect.check.free_depth_m *= 1.0 / 3;
  options.scene.judge_given_others = false;
  msgs::GroupTask message = task_message(frame, request, options, *front);
  message.models = {2};
  message.budget_ms = 31;
  const auto task = task_from(message, *front);
  ASSERT_TRUE(task.ok()) << task.status().message;
  EXPECT_EQ(task->frame.depth, frame.depth);
  EXPECT_EQ(task->frame.color, frame.color);
  EXPECT_EQ(task->frame.mask, frame.mask);
  EXPECT_EQ(task->frame.background, frame.background);
  EXPECT_EQ(task->frame.roi, frame.roi);
  EXPECT_EQ(task->frame.camera.cx, frame.camera.cx);
  EXPECT_EQ(task->request.seed, request.seed);
  ASSERT_EQ(task->request.priors.size(), 1U);
  EXPECT_EQ(task->request.priors[0].position->mean, prior.position->mean);
  ASSERT_EQ(task->request.expected.size(), 1U);
  EXPECT_EQ(task->request.expected[0].frame_from_object.rotation.coeffs(), pose.rotation.coeffs());
  ASSERT_EQ(task->models.size(), 1U);
  EXPECT_EQ(task->models[0]->name, "plate");
  EXPECT_EQ(task->request.models, std::vector<std::string>{"plate"});
  EXPECT_EQ(task->request.budget_ms, 31);
  auto read = options_from(message.options);
  ASSERT_TRUE(read.ok()) << read.status().message;
  const auto sent = options_of(options), got = options_of(*read);
  ASSERT_EQ(sent.size(), got.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (const auto* value = std::get_if<double*>(&sent[i].value)) {
      EXPECT_EQ(**value, *std::get<double*>(got[i].value)) << sent[i].path;
    } else if (const auto* flag = std::get_if<bool*>(&sent[i].value)) {
      EXPECT_EQ(**flag, *std::get<bool*>(got[i].value)) << sent[i].path;
    } else if (const auto* count = std::get_if<int*>(&sent[i].value)) {
      EXPECT_EQ(**count, *std::get<int*>(got[i].value)) << sent[i].path;
    }
  }
  message.options.push_back("check.no_such=1");
  EXPECT_EQ(options_from(message.options).status().code, StatusCode::invalid_argument);
  const auto code_with = [&](const auto& change) {
    msgs::GroupTask copy = message;
    change(copy);
    return task_from(copy, *front).status().code;
  };
  EXPECT_EQ(code_with([](auto& changed) { changed.models = {2, 2}; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& changed) { changed.models = {}; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& changed) { changed.models = {9}; }), StatusCode::not_found);
  EXPECT_EQ(code_with([](auto& changed) { changed.expected_poses.pop_back(); }),
            StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& changed) { changed.frame.depth.pop_back(); }),
            StatusCode::invalid_argument);
  EXPECT_EQ(code_with([](auto& changed) { changed.budget_ms = -1; }), StatusCode::invalid_argument);
}

TEST_F(GroupLibrary, AnswerComesBackWholeOrNotAtAll) {
  const auto front = front_library();
  const Models& models = front->models.models();
  SearchResult found;
  found.candidates.push_back({.model = models[1].get(), .explained = {7}});
  found.missed = {{"brick", 0.25}, {"plate", 1.5}};
  found.effort.pose_checks = 1234;
  found.cut = true;
  found.preparation_ms = 3.5;
  msgs::GroupAnswer message;
  put_result(found, message);
  const auto back = result_from(message, models, 100);
  ASSERT_TRUE(back.ok()) << back.status().message;
  ASSERT_EQ(back->candidates.size(), 1U);
  EXPECT_EQ(back->candidates[0].model, models[1].get());
  EXPECT_EQ(back->missed[1].model, "plate");
  EXPECT_EQ(back->missed[1].expected, 1.5);
  EXPECT_EQ(back->effort, found.effort);
  EXPECT_TRUE(back->cut);
  EXPECT_EQ(back->preparation_ms, 3.5);

  const auto code_with = [&](const auto& change) {
    msgs::GroupAnswer changed = message;
    change(changed);
    return result_from(changed, models, 100).status().code;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_with([](auto& answer) { answer.missed.pop_back(); }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) { answer.missed[0] = -1; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) { answer.effort[2] = -2000000000; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) { answer.effort.push_back(1); }), StatusCode::corrupt);
  EXPECT_EQ(code_with([&](auto& answer) { answer.busy_ms = nan; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) { answer.candidates[0].model = 3; }), StatusCode::corrupt);
  EXPECT_EQ(code_with([&](auto& answer) { answer.candidates[0].score = nan; }),
            StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) {
              answer.candidates[0].explained = {5, 5};
            }),
            StatusCode::corrupt);
  EXPECT_EQ(
      code_with([](auto& answer) { answer.candidates.resize(10000, answer.candidates.front()); }),
      StatusCode::corrupt);
  EXPECT_EQ(code_with([](auto& answer) {
              answer.status.code = static_cast<std::uint8_t>(StatusCode::busy);
            }),
            StatusCode::busy);
}

TEST_F(GroupLibrary, CandidateComesBackToTheBitOrNotAtAll) {
  const auto front = front_library();
  detect::Candidate candidate{.model = front->find(1).get()};
  candidate.refinement.frame_from_object = {Eigen::Quaterniond(0.1, 0.7, -0.3, 0.2).normalized(),
                                            {0.1, 1.0 / 3, 0.7}};
  candidate.refinement.information.setRandom();
  candidate.refinement.num_correspondences = 12;
  candidate.found_by = detect::Source::pairs;
  candidate.values.fill(1.0 / 3);
  candidate.score = 1.0 / 7;
  candidate.explained = {1, 5, 99};
  const auto back = candidate_from(to_message(candidate), *candidate.model, 100);
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(back->pose().rotation.coeffs(), candidate.pose().rotation.coeffs());
  EXPECT_EQ(back->pose().translation, candidate.pose().translation);
  EXPECT_EQ(back->refinement.information, candidate.refinement.information);
  EXPECT_EQ(back->values, candidate.values);
  EXPECT_EQ(back->score, candidate.score);
  EXPECT_EQ(back->explained, candidate.explained);
  EXPECT_EQ(back->found_by, candidate.found_by);
  EXPECT_FALSE(
      candidate_from(to_message(candidate), *candidate.model, 99).ok());  // a pixel outside
  msgs::GroupCandidate broken = to_message(candidate);
  broken.pose.fill(0);
  EXPECT_FALSE(candidate_from(broken, *candidate.model, 100).ok());
  broken = to_message(candidate);
  broken.values.pop_back();
  EXPECT_FALSE(candidate_from(broken, *candidate.model, 100).ok());
  msgs::GroupCandidate found = to_message(candidate);
  for (found.found_by = 0; found.found_by < static_cast<int>(detect::Source::count);
       ++found.found_by) {
    EXPECT_TRUE(candidate_from(found, *candidate.model, 100).ok()) << int{found.found_by};
  }
  EXPECT_EQ(candidate_from(found, *candidate.model, 100).status().code, StatusCode::corrupt);
}

}  // namespace
}  // namespace bpa::server::group
