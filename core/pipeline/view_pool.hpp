// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/pipeline/views.hpp"
#include "core/scene/given_others.hpp"

namespace bpa {

/// The placements of several views, each in every view. Keeps references.
class ViewPool {
 public:
  ViewPool(const Detector& detector, std::span<const ViewSearch* const> views,
           std::vector<Pose> scene_from_camera, const DetectRequest& request,
           const ViewsOptions& options);

  /// Finds out which placements of different views are one, and scores each in the views that did
  /// not find it.
  void gather();
  /// Compares poses that claim one place, in each view.
  void compare();
  /// The placements with the evidence of all views. Their poses are scene_from_object.
  detect::Candidates joined() const;
  /// Which of joined() share pixels or exclude one another in any view.
  scene::Overlaps overlaps(const detect::Candidates& joined) const;
  /// Judges each placement in each view, given the others that are `present` (joined()).
  void judge(const scene::Present& present, const scene::Overlaps& overlaps);
  /// Searched pixels of all views.
  int observed_pixels() const;
  const SearchEffort& effort() const { return effort_; }

 private:
  struct Found;  // a placement of one view, in the fixed frame
  struct Joint;  // a pose that several views agree on
  /// One placement: what it is in each view, and where all views that know it say it is.
  struct Entry {
    const ObjectModel* model = nullptr;
    Eigen::Vector3d place{0, 0, 0};  ///< Of the object's centre, as first found; fixed frame.
    detect::Candidates in_view;      ///< One for each view, camera frame.
    std::vector<bool> known;         ///< Whether it is scored there.
  };

  std::vector<Found> all_found() const;
  void add(const Found& found);
  bool same(const Entry& entry, const Found& found) const;
  Joint joint(const Entry& entry) const;
  detect::Candidate joined(const Entry& entry) const;
  void score_in(int view, const ObjectModel& model, SearchEffort& effort);
  void compare_in(int view, const ObjectModel& model);
  detect::Search search_in(int view, const ObjectModel& model) const;
  void for_each_model_and_view(
      const std::function<void(int view, const ObjectModel&, SearchEffort&)>& work);

  const Detector& detector_;
  std::span<const ViewSearch* const> views_;
  std::vector<Pose> scene_from_camera_;
  const DetectRequest& request_;
  const ViewsOptions options_;
  const detect::DetectPlan plan_;
  std::vector<std::vector<PosePrior>> priors_;  ///< Of each view, camera frame.
  std::vector<std::uint32_t> first_pixel_;      ///< Of each view among the pixels of all.
  std::vector<Entry> entries_;
  SearchEffort effort_;
};

}  // namespace bpa
