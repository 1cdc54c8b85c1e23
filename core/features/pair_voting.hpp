// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/shared_array.hpp"
#include "core/cloud/match_color.hpp"
#include "core/cloud/point_cloud.hpp"
#include "core/features/rim_points.hpp"

namespace bpa::features {

/// The four rigid invariants of two oriented points (Drost et al., "Model Globally, Match Locally",
/// CVPR 2010).
struct PointPairFeature {
  float distance = 0;       ///< Metres.
  float angle_first = 0;    ///< Between the first normal and the line to the second, radians.
  float angle_second = 0;   ///< Between the second normal and that line.
  float angle_normals = 0;  ///< Between the normals.
};

PointPairFeature point_pair_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                    const Eigen::Vector3f& q, const Eigen::Vector3f& nq);

/// True when the pair fixes a pose: normals that differ by 20 degrees or more, or points that are
/// not in one another's tangent plane.
bool fixes_pose(const PointPairFeature& feature);

/// The feature of a point and a rim of its face; nothing if the rim is of another face. Pairs
/// within one flat face fix no pose, but pairs with its rim do (compare Choi et al., "Voting-Based
/// Pose Estimation for Robotic Assembly Using a 3D Sensor", ICRA 2012). `angle_second` is between
/// the line and the rim's outward direction. The other two angles are constants.
std::optional<PointPairFeature> rim_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                            const RimPoint& rim);

/// The longest pair that a search may look up, metres. Tables hold no longer ones, which would be
/// most of the pairs of a large model. What is mostly hidden has no long pairs.
constexpr double kMaxPairLength = 0.08;

constexpr int kPairAngleBins = 12;  ///< 15 degrees each.
constexpr int kTurnSteps = 256;     ///< Of a full turn about a normal.

/// In place of an index in a palette, where the colour is not known. With it, 32 bits say which
/// colours of a palette agree with one.
constexpr std::uint8_t kAnyColor = 31;

/// A basis whose third axis is `normal` (unit length); the other two follow from it alone. Turns
/// about a normal are measured from the first axis toward the second.
Eigen::Matrix3f basis_of(const Eigen::Vector3f& normal);

/// The ordered pairs of a model's points that fix a pose, hashed by their quantised feature: those
/// found under distances up to kMaxPairLength. Pairs in the outer quarter of a bin are also found
/// from the next bin: noise seldom hides them.
class PointPairTable {
 public:
  /// `distance_step` in metres. `colors`: each point's index in a palette of at most kAnyColor
  /// colours; empty without colours.
  PointPairTable(const PointCloud& points, float distance_step,
                 std::span<const std::uint8_t> colors = {});

  /// The pairs of a point and a rim of the face that it is on, under rim_feature().
  PointPairTable(const PointCloud& points, std::span<const RimPoint> rims, float distance_step);

  /// One pair: its first point, and where the second lies about the first's normal.
  struct Entry {
    std::uint16_t point = 0;
    std::uint8_t turn = 0;           ///< In kTurnSteps.
    std::uint8_t color = kAnyColor;  ///< Of the second point, in the palette.

    bool operator==(const Entry&) const = default;
  };
  /// What a table consists of; for files.
  struct Arrays {
    float inverse_step = 1;            ///< One over the distance step, 1 / metres.
    float max_distance = 0;            ///< See max_distance().
    SharedArray<std::uint32_t> first;  ///< first[key]..first[key + 1] is the cell; may be empty.
    SharedArray<Entry> entries;

    /// Whether no lookup can leave the arrays, all points are below `num_points`, and colours at
    /// most kAnyColor.
    bool fit(std::size_t num_points) const;
  };
  /// `arrays` must fit the points that the table is of.
  explicit PointPairTable(Arrays arrays)
      : inverse_step_(arrays.inverse_step),
        max_distance_(arrays.max_distance),
        first_(std::move(arrays.first)),
        entries_(std::move(arrays.entries)) {}
  Arrays arrays() const { return {inverse_step_, max_distance_, first_, entries_}; }

  /// The pairs found under a distance and three angles quantised by pair_angle_key().
  std::span<const Entry> lookup(float distance, std::uint16_t angle_key) const {
    if (!(distance <= max_distance_ + 1 / inverse_step_)) return {};
    const auto bin = static_cast<std::uint32_t>(distance * inverse_step_);
    const std::size_t key = bin * kAngleKeys + angle_key;
    if (key + 1 >= first_.size()) return {};
    return {entries_.data() + first_[key], first_[key + 1] - first_[key]};
  }
  /// Of all pairs that fix a pose, also of those not held, metres.
  float max_distance() const { return max_distance_; }

  static constexpr std::uint32_t kAngleKeys = kPairAngleBins * kPairAngleBins * kPairAngleBins;

 private:
  void fill(const PointCloud& points, const auto& for_each_pair);

  float inverse_step_ = 1;
  float max_distance_ = 0;
  SharedArray<std::uint32_t> first_;  // first_[key]..first_[key + 1] is the cell
  SharedArray<Entry> entries_;
};

/// The three angles, quantised.
std::uint16_t pair_angle_key(const PointPairFeature& feature);
/// Where `line` points about the normal that `basis` (basis_of) stands on, in kTurnSteps.
std::uint8_t turn_of(const Eigen::Matrix3f& basis, const Eigen::Vector3f& line);

/// Pairs of a scene's points about some reference points; made once, looked up in every model.
struct ScenePairs {
  struct Partner {
    float distance = 0;           ///< To the reference point, metres.
    std::uint16_t angle_key = 0;  ///< pair_angle_key of the pair.
    std::uint8_t turn = 0;        ///< turn_of the line to the partner, about the reference normal.
    std::int32_t point = -1;      ///< Its index in the cloud; -1 where it is not of the cloud.
  };
  std::vector<int> references;       ///< Indices of the reference points.
  std::vector<std::uint32_t> first;  ///< first[r]..first[r + 1] are the partners of the r-th,
  std::vector<Partner> partners;     ///< by rising distance.
};

/// Of the pairs within `reach` metres that fix a pose, about the points `references`, one in
/// `step`: those whose indices add up to a multiple of it. `partners` flags the points that may be
/// partners; without it, all may.
ScenePairs scene_pairs(const PointCloud& cloud, std::vector<int> references, float reach, int step,
                       int num_threads, std::span<const std::uint8_t> partners = {});

/// All pairs of the points `references` within `reach` metres of a rim of the face they are on.
ScenePairs scene_rim_pairs(const PointCloud& cloud, std::span<const RimPoint> rims,
                           std::vector<int> references, float reach, int num_threads);

/// A reference point laid on a model point, turned about its normal: a pose that many pairs vote
/// for.
struct VotedPose {
  int reference = 0;    ///< Index of the scene point.
  int model_point = 0;  ///< Index of the model point that `PointPairTable` was made of.
  float turn = 0;       ///< From the model point's basis to the scene point's, radians.
  int votes = 0;
};

/// Colours of the scene's points, by index, and of the model's; the palette of the table's entries.
/// Without either of the first two, colours do not count.
struct PairColors {
  std::span<const MatchColor> scene, model, palette;
};

/// Each reference point's pairs vote for its model point and the turn about its normal (Drost et
/// al., section 3.4). Returns the `peaks` best model points of each reference point, best first.
/// With colours, those alone whose colour agrees with the reference point's, and by votes of those
/// pairs alone whose second points' colours agree (compare Choi and Christensen, IROS 2012).
/// `num_model_points` is the size of the cloud of `table`. Ends once `late`, if given, says so.
std::vector<VotedPose> vote_poses(const ScenePairs& pairs, const PointPairTable& table,
                                  int num_model_points, int peaks, const PairColors& colors = {},
                                  const std::function<bool()>& late = {});

}  // namespace bpa::features
