// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/library_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <span>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"
#include "core/cloud/cielab.hpp"
#include "core/modeling/registration.hpp"

namespace bpa::doctor {
namespace {

/// The share of two models' colours that is the same, 0 to 1: the intersection of their histograms
/// in CIELAB.
double common_colors(const PointCloud& a, const PointCloud& b) {
  constexpr float kBin = 20;  // CIELAB units, ten times what is just noticeable
  const CielabConverter to_lab;
  const auto histogram = [&](const PointCloud& cloud) {
    std::map<std::array<int, 3>, double> shares;
    for (const auto& [red, green, blue] : cloud.colors) {
      const Eigen::Vector3f lab = to_lab(Eigen::Vector3f(red, green, blue)) / kBin;
      const Eigen::Vector3i bin = lab.array().round().cast<int>();
      shares[{bin.x(), bin.y(), bin.z()}] += 1 / static_cast<double>(cloud.size());
    }
    return shares;
  };
  const auto shares_a = histogram(a), shares_b = histogram(b);
  double common = 0;
  for (const auto& [bin, share] : shares_a) {
    const auto same = shares_b.find(bin);
    if (same != shares_b.end()) common += std::min(share, same->second);
  }
  return common;
}

/// "a, b and 3 more", of at least one name.
std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 4;
  const std::string text = listed(std::span(names).first(std::min(kNamed, names.size())));
  return names.size() > kNamed ? concat(text, " and ", names.size() - kNamed, " more") : text;
}

double median_depth(const Frame& frame) {
  std::vector<float> depths;
  std::ranges::copy_if(frame.depth, std::back_inserter(depths), [](float z) { return z > 0; });
  if (depths.empty()) return 0;
  return static_cast<double>(median(depths));
}

/// The area that a model's box covers on average over all views, square metres: by Cauchy, a
/// quarter of its surface. The model covers less.
double mean_area(const ModelSource& model) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : model.surface.points) box.extend(point);
  const Eigen::Vector3d s = box.sizes().cast<double>();
  return 0.5 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
}

}  // namespace

Findings check_look_alikes(const std::vector<ModelSource>& models, bool with_color,
                           int num_threads) {
  constexpr double kSameColors = 0.7;  // chosen by hand
  Findings findings;
  for (std::size_t i = 0; i < models.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const ModelSource &a = models[j], &b = models[i];
      const bool colored = with_color && !a.surface.colors.empty() && !b.surface.colors.empty();
      if (colored && common_colors(a.surface, b.surface) < kSameColors) continue;
      if (!modeling::same_shape(a, b, num_threads)) continue;
      findings.push_back({Severity::warning, a.name + " and " + b.name + " look alike",
                          colored ? "nearly the same shape and colours"
                                  : "nearly the same shape, and no colours to tell them apart",
                          "Search for one of them (--models), make coloured models of both, or "
                          "treat them as one."});
    }
  }
  return findings;
}

Findings check_models_in_frame(const std::vector<ModelSource>& models, const Frame& frame,
                               const DetectorLimits& limits) {
  const double z = std::min(median_depth(frame), limits.max_range_m);
  if (!(z > 0)) return {};
  int width = frame.camera.width;
  while (width > limits.max_width) width /= 2;
  const double reduction = static_cast<double>(frame.camera.width) / width;
  const double pixels_per_area =
      frame.camera.fx * frame.camera.fy / (z * z * reduction * reduction);
  const double view =
      std::max(frame.camera.width * z / frame.camera.fx, frame.camera.height * z / frame.camera.fy);
  std::vector<std::string> small, large, grey;
  for (const ModelSource& model : models) {
    const double pixels = mean_area(model) * pixels_per_area;
    if (pixels < limits.check_points)
      small.push_back(concat(model.name, " (", fixed(pixels, 0), ")"));
    if (model.diameter > view)
      large.push_back(concat(model.name, " (", fixed(model.diameter, 2), " m)"));
    if (model.surface.colors.empty() && !frame.color.empty()) grey.push_back(model.name);
  }
  const std::string at = concat(" at the scene's median depth of ", fixed(z, 2), " m");
  Findings findings;
  if (!small.empty()) {
    findings.push_back({Severity::warning, "models are too small for the distance",
                        concat(list_of(small), " pixels of the searched image", at,
                               "; a pose is checked with ", limits.check_points, " points"),
                        "Move the camera nearer, use a larger image and raise surface.max_width."});
  }
  if (!large.empty()) {
    findings.push_back({Severity::warning, "models are larger than the view",
                        concat(list_of(large), "; the view is ", fixed(view, 2), " m wide", at),
                        "Move the camera away, or check the unit of the mesh (--scale)."});
  }
  if (!grey.empty()) {
    findings.push_back({Severity::warning, "models have no colour, but the frame has",
                        list_of(grey) + ": objects of similar shape are confused",
                        "Make these models of coloured meshes or of scans."});
  }
  return findings;
}

}  // namespace bpa::doctor
