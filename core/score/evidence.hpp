// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/model/model_index.hpp"
#include "core/observation/scene_features.hpp"
#include "core/score/color_score.hpp"
#include "core/score/feature_score.hpp"
#include "core/score/predicted_surface.hpp"
#include "core/score/resting_score.hpp"
#include "core/score/segment_scores.hpp"
#include "core/score/silhouette_score.hpp"
#include "core/score/surface_agreement.hpp"
#include "core/score/texture_score.hpp"

namespace bpa::score {

/// What the score components of one placement are computed from. Each part is computed once, when a
/// component first asks for it. Keeps references.
class Evidence {
 public:
  /// `max_points` as for measure_surface(). `pose` is camera_from_object. `predicted` is of that
  /// pose, where it is known.
  Evidence(const SceneFeatures& scene, const FeaturePlaces& places, const Pose& pose,
           int max_points = 0, std::optional<PredictedSurface> predicted = {})
      : scene_(scene),
        places_(places),
        pose_(pose),
        max_points_(max_points),
        predicted_(std::move(predicted)) {}

  const SceneFeatures& scene() const { return scene_; }
  const ObjectModel& model() const { return places_.model(); }
  const FeaturePlaces& places() const { return places_; }
  const Pose& pose() const { return pose_; }
  /// The edge image (paper V.2).
  const Image<float>& edges() const { return scene_.edges.likelihood; }

  const SurfaceAgreement& surface() {
    if (!surface_) {
      surface_ = measure_surface(scene_.image, model(), pose_, max_points_,
                                 max_points_ == 0 ? &explained_ : nullptr);
    }
    return *surface_;
  }
  /// The explained pixels, as of measure_surface(), if all points are looked at; moved out.
  std::vector<std::uint32_t> take_explained() {
    surface();
    return std::move(explained_);
  }
  const PredictedSurface& predicted() {
    if (!predicted_) predicted_ = predict_surface(scene_.image, model(), pose_);
    return *predicted_;
  }
  const std::vector<SegmentMatch>& segments() {
    if (!segments_) {
      segments_ = match_segments(scene_.segmentation, scene_.map, model(), pose_, predicted());
    }
    return *segments_;
  }
  const ColorAgreement& colors() {
    if (!colors_) {
      colors_ = compare_colors(scene_.image, scene_.cielab, model().index->cielab, predicted());
    }
    return *colors_;
  }
  const TextureAgreement& texture() {
    if (!texture_) texture_ = compare_texture(scene_.image, scene_.log_light, model(), predicted());
    return *texture_;
  }
  const RestingAgreement& resting() {
    if (!resting_) resting_ = compare_resting(scene_.image, scene_.planes, model(), pose_);
    return *resting_;
  }
  const SilhouetteAgreement& silhouette() {
    if (!silhouette_) {
      silhouette_ = compare_silhouette(scene_.image, scene_.gradients, predicted());
    }
    return *silhouette_;
  }

 private:
  const SceneFeatures& scene_;
  const FeaturePlaces& places_;
  const Pose& pose_;
  int max_points_;
  std::vector<std::uint32_t> explained_;
  std::optional<SurfaceAgreement> surface_;
  std::optional<PredictedSurface> predicted_;
  std::optional<std::vector<SegmentMatch>> segments_;
  std::optional<ColorAgreement> colors_;
  std::optional<TextureAgreement> texture_;
  std::optional<SilhouetteAgreement> silhouette_;
  std::optional<RestingAgreement> resting_;
};

}  // namespace bpa::score
