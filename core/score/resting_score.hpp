// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/cloud/planes.hpp"
#include "core/geometry/pose.hpp"
#include "core/model/object_model.hpp"
#include "core/observation/check_image.hpp"
#include "core/score/likelihood.hpp"

namespace bpa::score {

/// How a placement relates to the large planes of the scene, on which objects lie.
struct RestingAgreement {
  /// Share of the model's points beneath a plane that is seen there.
  double below = kNotKnown;
  /// From the largest plane to the model's lowest point, metres, beyond the centimetre that the
  /// sensor may be off: 0 within it. Clamped to [-0.05, 0.2].
  double gap = kNotKnown;
  /// How far the centre is inside the convex hull of what touches the plane, in diameters; negative
  /// outside, where the object would fall over. Known where the gap is within 15 mm.
  double balance = kNotKnown;
};

/// `planes` as label_background_planes() gives them; nothing is known without planes.
RestingAgreement compare_resting(const CheckImage& image, std::span<const Plane> planes,
                                 const ObjectModel& model, const Pose& camera_from_object);

}  // namespace bpa::score
