// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/cloud/image.hpp"
#include "core/model/object_model.hpp"
#include "core/score/predicted_surface.hpp"

namespace bpa::score {

/// Whether pixels have the colour of an object or that of what is around it, under one pose. Keeps
/// references.
class FigureColors {
 public:
  /// `colors` is log_light() of the reduced image. The light is taken from the pixels that the pose
  /// explains. Colours of the model count where it has some, and the object's colours in the image.
  FigureColors(const CheckImage& image, const Image<Eigen::Vector3f>& colors,
               const ObjectModel& model, const PredictedSurface& predicted);

  const PredictedSurface& predicted() const { return predicted_; }
  /// True when enough is explained to know the object's colours; false without `colors`.
  bool known() const { return known_; }
  /// log p(observed colour) of a pixel: of the object where the pose covers it, else of what is
  /// around it and outside of `other` as well; not known where nothing of that is near.
  double log_likelihood(int u, int v, const PredictedSurface& other) const;

 private:
  double of_object(int u, int v) const;
  double of_surroundings(int u, int v, const PredictedSurface& other) const;

  const CheckImage& image_;
  const Image<Eigen::Vector3f>& colors_;
  const ObjectModel& model_;
  const PredictedSurface& predicted_;
  std::vector<Eigen::Vector3f> explained_;  // colours of the object in the image
  Eigen::Vector3f light_ = Eigen::Vector3f::Zero();
  bool known_ = false;
};

}  // namespace bpa::score
