// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/calibration/surface_alignment.hpp"
#include "core/pipeline/detector.hpp"
#include "core/pipeline/views_options.hpp"

// Several frames of one scene that stands still: of several cameras at nearly one time, or of one
// camera on an arm that looks from several places. Each frame is searched by itself. Then every
// placement is scored in every view, with that view's own visibility and noise, and the evidence of
// all views is multiplied. README.md of this room says how.

namespace bpa {

/// One frame of the scene, and where its camera was.
struct View {
  Frame frame;
  Pose scene_from_camera;              ///< Of the optical frame, in the fixed frame; metres.
  std::vector<PosePrior> priors = {};  ///< Further ones of this view, in its camera frame.
};

/// What one view shows by itself.
struct ViewSearch {
  SceneFeatures scene;            ///< In the camera frame.
  detect::Candidates candidates;  ///< Of all models; the detector's library must live as long.
  SceneInterpretations alone;     ///< Detector::detect() of the frame, in the camera frame.
};

/// What all views show together.
struct ViewsResult {
  /// In the fixed frame: frame_from_object is scene_from_object. A visible_fraction is that of the
  /// view that sees most of the object. Covariances hold the expected error of the cameras' poses.
  /// The stamp is the latest frame's, `frame_id` is empty.
  SceneInterpretations scene;
  std::vector<Pose> scene_from_camera;  ///< As used: aligned with align_cameras.
  std::vector<calibration::SurfaceDisagreement> disagreements;  ///< Of pairs of views, as given.
  std::vector<std::string> warnings;  ///< For people: a sentence for each pair that disagrees.
};

/// What one view says of a placement.
struct ViewEvidence {
  double log_odds = 0;    ///< By the learned layer, without priors.
  double visibility = 0;  ///< Of the model surface that faces the camera, 0 to 1.
};

/// The log odds of a placement that several views see. A view without visibility adds nothing; one
/// view that sees it gives its own log odds. See ViewsOptions::independence.
double combined_log_odds(std::span<const ViewEvidence> views, const ViewsOptions& options);

/// Searches one view, here or on other hosts. Priors and expected placements of `request` are in
/// the camera frame. Errors as of Detector::detect().
Result<ViewSearch> search_view(const Detector& detector, const Frame& frame,
                               const DetectRequest& request, const RemoteSearch& elsewhere = {});

/// Joins views that were searched, at least one. `scene_from_camera` has a pose for each view.
/// Priors of `request` are in the fixed frame. The same answer for any number of threads.
ViewsResult combine_views(const Detector& detector, std::span<const ViewSearch* const> views,
                          std::span<const Pose> scene_from_camera, const DetectRequest& request);

/// Searches all views and joins them. Priors and expected placements are in the fixed frame. The
/// time budget is that of all views together. Fails as Detector::detect() does, naming the view,
/// and with invalid_argument without a view, on more than kMostViews or on a pose that is no rigid
/// motion. `on_round` is not called. With `elsewhere`, other hosts search.
Result<ViewsResult> detect_views(const Detector& detector, std::span<const View> views,
                                 const DetectRequest& request = {},
                                 const RemoteSearches& elsewhere = {});

constexpr std::size_t kMostViews = 16;  ///< Chosen by hand: memory grows with their number.

}  // namespace bpa
