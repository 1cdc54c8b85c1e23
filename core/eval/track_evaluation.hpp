// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "core/eval/evaluation.hpp"
#include "core/io/tracks.hpp"

// How well tracks follow the objects of a sequence, by the measures of the field, in 3-D:
//
// - An estimate may be matched with an instance of its model whose origin is at most `match_m`
// away,
//   modulo the symmetry. In each frame pairs of the frame before stay, the others are assigned with
//   the smallest sum of distances (CLEAR MOT, Bernardin and Stiefelhagen 2008).
// - MOTA = 1 - (missed + false + switches) / instances. MOTP is the mean distance of matches.
// - IDF1 (Ristani et al. 2016): each object is given one track of the whole sequence, so that as
//   many pairs as possible within `match_m` agree. 2 agreeing / (instances + estimates).
// - ADD-S AUC (YCB-Video, Xiang et al. 2018): the area under the share of instances with an ADD-S
//   below a threshold, from 0 to 0.1 m. An instance without a match has none.
//
// An instance counts while at least `min_visible_fraction` of it is visible; in the second column
// also while it is hidden, for at most `hidden_s` after it was last visible. What is matched with
// an instance that does not count is neither right nor false.

namespace bpa::eval {

struct TrackEvaluationOptions {
  BPA_OPTION(double, match_m, 0.05, (0.001, 1), "Largest distance of a match, metres.");
  BPA_OPTION(double, min_visible_fraction, 0.1, (0, 1), "Less visible instances are hidden.");
  BPA_OPTION(double, hidden_s, 1, (0, 60),
             "Seconds for which a hidden instance counts, after it was visible.");
  BPA_OPTION(int, num_threads, 0, (0, 256), "0 = one per core.");
};

/// Sums over frames; the measures come from them.
struct TrackCounts {
  int instances = 0;  ///< That count.
  int matched = 0;
  int false_reports = 0;
  int switches = 0;          ///< Matches with another track than the instance's match before.
  int objects = 0;           ///< Instances of a sequence by identity.
  int identity_matched = 0;  ///< Of IDF1: matches by the one track of each object.
  double distance_sum = 0;   ///< Of matches, metres.
  double adds_area_sum = 0;  ///< Of instances: 1 - ADD-S / 0.1 m, or 0.
  int within_2cm = 0;        ///< Instances with an ADD-S below 2 cm.
  int right = 0;             ///< Instances whose match is within 2.5 cm and pi/16.

  int estimates() const { return matched + false_reports; }
  double mota() const;
  double motp_m() const;
  double idf1() const;
  double adds_auc() const;

  TrackCounts& operator+=(const TrackCounts& other);
};

/// One sequence, or the sum of all.
struct TrackMeasures {
  std::string name;
  int frames = 0;
  TrackCounts visible;  ///< Only instances that are visible.
  TrackCounts all;      ///< Also those hidden for a short time.
  Ratio hidden_held;    ///< Of those hidden for a short time, the matched ones.
  Ratio right_at_end;   ///< In the last frame of a sequence: visible instances with a right pose.
  /// Confirmed tracks matched with a visible instance: the mean of the normalised error squared for
  /// each degree of freedom (1 is right), and how many are within the 95 % quantile of chi-squared.
  double nees_sum = 0;
  Ratio nees_within;
  std::vector<double> milliseconds;  ///< Of the frames with a result, ascending.

  double nees() const { return nees_within.total > 0 ? nees_sum / nees_within.total : 0; }
  /// The time that this share of the frames keeps; 0 without frames.
  double milliseconds_at(double share) const;
};

struct TrackReport {
  TrackEvaluationOptions options;
  std::vector<TrackMeasures> sequences;  ///< By scene_id.
  TrackMeasures total;
};

/// Compares tracks with the truth. Confirmed and occluded tracks are estimates; a frame without a
/// result has none. Fails with invalid_argument where a result names an unknown frame or object, or
/// an instance has no identity (io::BopInstance::instance).
Result<TrackReport> evaluate_tracks(const std::vector<io::BopFrame>& frames,
                                    const EvalObjects& objects,
                                    const std::vector<io::TrackResult>& results,
                                    const TrackEvaluationOptions& options = {});

/// Detections of each frame alone as tracks, to compare with: the placements of the best
/// interpretations. A placement takes the id of the nearest one of its model in the frame before,
/// at most `reach_m` away in the camera's frame, else a new id. Each id is taken by at most one.
std::vector<io::TrackResult> linked_detections(const std::vector<io::FrameResult>& results,
                                               double reach_m = 0.1);

/// The report as a table for people.
std::string track_report_text(const TrackReport& report);
/// The report as JSON.
std::string track_report_json(const TrackReport& report);

}  // namespace bpa::eval
