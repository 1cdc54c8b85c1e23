// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace bpa::score {

/// How soon a search finds what is in sight: measured by `bpa train`, and stored with the score
/// layers. A try is a reference point of the scene that is looked up in a model.
struct SearchYield {
  /// The chance that a try on an object finds it differs between objects: it has a gamma
  /// distribution of this shape and mean shape / tries, 1 / try.
  double shape = 1, tries = 1;
  /// Of an object's surface, the share in sight.
  double visible = 0.5;
  /// The expected number of objects in sight has a gamma distribution: as if so many objects had
  /// been counted in so many scenes.
  double objects = 1, scenes = 1;

  /// The probability that an object in sight is undiscovered after so many tries on it.
  double undiscovered(double tried) const { return std::pow(tries / (tries + tried), shape); }
  bool is_valid() const {
    return shape > 0 && tries > 0 && visible > 0 && visible <= 1 && objects > 0 && scenes > 0;
  }
};

/// For frames and models with and without colours.
struct LearnedYield {
  SearchYield with_color, without_color;
  std::string provenance;  ///< Who measured them on what, for people.
};

/// An object in sight that a search found: after how many tries on it.
struct Discovery {
  double after = 0;    ///< So many did not find it.
  double at_most = 0;  ///< So many did; more than `after`.
  double visible = 0;  ///< Of its surface, the share in sight.
};

/// Maximum likelihood of `shape` and `tries`, the mean of `visible`, and the gamma distribution
/// with the mean and variance of the frames' numbers of objects. With fewer than 50 discoveries:
/// `start`.
SearchYield measure_yield(const std::vector<Discovery>& discoveries,
                          const std::vector<int>& objects_in_frames, const SearchYield& start);

}  // namespace bpa::score
