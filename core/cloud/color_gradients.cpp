// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/cloud/color_gradients.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/cloud/blur.hpp"
#include "core/cloud/cielab.hpp"

namespace bpa {
namespace {

constexpr double kGradientBlur = 1;  // pixels
constexpr float kHalfStrength = 2;   // CIELAB a pixel; noise leaves 0.5

}  // namespace

Image<Eigen::Vector2f> color_gradients(const Frame& frame, int num_threads) {
  if (frame.color.empty()) return {};
  SurfaceMap full;  // not reduced
  full.camera = frame.camera;
  const Image<Eigen::Vector3f> rgb = reduced_color(frame, full, num_threads);
  const Image<Eigen::Vector3f> lab = blur(cielab(rgb, num_threads), kGradientBlur, num_threads);
  Image<Eigen::Vector2f> out(lab.width, lab.height, Eigen::Vector2f::Zero());
  parallel_for(
      static_cast<std::size_t>(std::max(0, lab.height - 2)), num_threads, [&](std::size_t row) {
        const int v = static_cast<int>(row) + 1;
        for (int u = 1; u + 1 < lab.width; ++u) {
          const Eigen::Vector3f across = 0.5f * (lab.at(u + 1, v) - lab.at(u - 1, v));
          const Eigen::Vector3f down = 0.5f * (lab.at(u, v + 1) - lab.at(u, v - 1));
          Eigen::Index most = 0;
          const float squared = (across.cwiseAbs2() + down.cwiseAbs2()).maxCoeff(&most);
          out.at(u, v) =
              Eigen::Vector2f(across[most], down[most]) / (std::sqrt(squared) + kHalfStrength);
        }
      });
  return out;
}

}  // namespace bpa
