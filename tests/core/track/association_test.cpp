// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/track/association.hpp"

#include <gtest/gtest.h>

namespace bpa::track {
namespace {

std::shared_ptr<const ObjectModel> model(const std::string& name) {
  auto out = std::make_shared<ObjectModel>();
  out->name = name;
  out->number = name == "mug" ? 1 : 2;
  out->diameter = 0.2;  // metres: its place is 8 cm wide
  return out;
}

const auto kMug = model("mug"), kBox = model("box");

Placement placed(const std::string& name, double x) {
  Placement out;
  out.model = name;
  out.frame_from_object.translation = {x, 0, 1};
  return out;
}

Placement likely(const std::string& name, double x, double probability) {
  Placement out = placed(name, x);
  out.probability = out.presence = probability;
  return out;
}

TrackRecord tracked(const std::shared_ptr<const ObjectModel>& of, double x,
                    Sight sight = Sight::seen, double unseen_s = 0) {
  return {1, of, placed(of->name, x).frame_from_object, sight, 1, unseen_s};
}

TEST(MatchTracks, ByModelAndPlace) {
  EXPECT_EQ(match_tracks({placed("mug", 0.01), placed("box", 0.01), placed("mug", 0.5)},
                         {tracked(kBox, 0), tracked(kMug, 0)}),
            (std::vector{1, 0, -1}));
}

TEST(MatchTracks, NearestPairsFirstAndEachTrackOnce) {
  EXPECT_EQ(match_tracks({placed("mug", 0.05), placed("mug", 0.01)},
                         {tracked(kMug, 0), tracked(kMug, 0.1)}),
            (std::vector{1, 0}));
  EXPECT_EQ(match_tracks({placed("mug", 0.02), placed("mug", 0.01)}, {tracked(kMug, 0)}),
            (std::vector{-1, 0}));
}

TEST(MatchTracks, WhatIsNotSeenMayHaveGoneFurther) {
  const std::vector<Placement> far = {placed("mug", 0.3)};
  EXPECT_EQ(match_tracks(far, {tracked(kMug, 0)}), std::vector{-1});
  EXPECT_EQ(match_tracks(far, {tracked(kMug, 0, Sight::hidden, 0.2)}), std::vector{-1});
  EXPECT_EQ(match_tracks(far, {tracked(kMug, 0, Sight::hidden, 1)}), std::vector{0});
  EXPECT_EQ(match_tracks({placed("mug", 0.7)}, {tracked(kMug, 0, Sight::absent, 60)}),
            std::vector{-1});
}

TEST(FoundObjects, ThoseOfOtherInterpretationsInPlacesOfTheirOwn) {
  ModelLibrary library;
  ASSERT_TRUE(library.add(kMug).ok());
  ASSERT_TRUE(library.add(kBox).ok());
  Placement open = likely("mug", 0.5, 0.3);
  open.presence = 0.75;
  Placement scattered = likely("mug", -0.5, 0.1);
  scattered.presence = 0.9;
  SceneInterpretations result;
  result.interpretations = {
      {.placements = {likely("box", 0, 0.9), likely("cup", -0.9, 0.9)}},
      {.rank = 2, .placements = {likely("mug", 0.05, 0.8), open, scattered, likely("box", 1, 0.4)}},
      {.rank = 3, .placements = {likely("mug", 0.53, 0.6)}}};
  const std::vector<Placement> found = found_objects(result, library, 0.5);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].model, "box");
  EXPECT_EQ(found[0].frame_from_object.translation.x(), 0);
  EXPECT_EQ(found[1].model, "mug");
  EXPECT_EQ(found[1].frame_from_object.translation.x(), 0.5);
}

TEST(ClaimsPlace, OnlyAnotherModelDoes) {
  EXPECT_TRUE(claims_place(placed("box", 0.02), tracked(kMug, 0)));
  EXPECT_FALSE(claims_place(placed("mug", 0.02), tracked(kMug, 0)));
  EXPECT_FALSE(claims_place(placed("box", 0.2), tracked(kMug, 0)));
}

}  // namespace
}  // namespace bpa::track
