// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/model/noise_model.hpp"

namespace bpa {

/// One bin of errors that were observed at nearly the same edge distance and surface angle.
struct NoiseBin {
  double edge_distance = 0;
  double angle = 0;
  double sigma = 0;  ///< Root mean square of the errors.
  double count = 0;
};

/// The curve under which the bins are most likely: weighted least squares on log(sigma), whose
/// variance is 1 / (2 count), by Levenberg-Marquardt from `start`. Bins of less than 30 errors do
/// not count. Returns `start` when fewer than 7 bins are left.
NoiseCurve fit_noise_curve(std::span<const NoiseBin> bins, const NoiseCurve& start);

}  // namespace bpa
