// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <pcl/features/fpfh.h>

#include "core/base/random.hpp"
#include "core/features/fpfh.hpp"

namespace bpa::features {
namespace {

constexpr float kRadius = 0.025f;

// A wavy surface with noisy normals, points about 5 mm apart.
PointCloud wavy_surface() {
  RandomStream random(1);
  PointCloud cloud;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const double u = 0.005 * x + 0.001 * random.uniform();
      const double v = 0.005 * y + 0.001 * random.uniform();
      cloud.points.push_back(
          Eigen::Vector3d(u, v, 0.8 + 0.02 * std::sin(40 * u) * std::cos(30 * v)).cast<float>());
      const Eigen::Vector3d normal(0.8 * std::cos(40 * u) * std::cos(30 * v),
                                   -0.6 * std::sin(40 * u) * std::sin(30 * v), -1);
      cloud.normals.push_back(
          (normal.normalized() +
           0.05 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()))
              .normalized()
              .cast<float>());
    }
  }
  return cloud;
}

std::vector<int> neighbors_of(const PointCloud& cloud, std::size_t i) {
  std::vector<int> found;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    if ((cloud.points[j] - cloud.points[i]).squaredNorm() <= kRadius * kRadius) {
      found.push_back(static_cast<int>(j));
    }
  }
  return found;
}

using Histogram = std::vector<double>;

// The simplified histograms, by PCL.
class PclHistograms {
 public:
  explicit PclHistograms(const PointCloud& cloud) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      points_.push_back({cloud.points[i].x(), cloud.points[i].y(), cloud.points[i].z()});
      normals_.push_back({cloud.normals[i].x(), cloud.normals[i].y(), cloud.normals[i].z()});
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      Eigen::MatrixXf a(1, 11), b(1, 11), c(1, 11);
      a.setZero(), b.setZero(), c.setZero();
      estimation_.computePointSPFHSignature(points_, normals_, static_cast<pcl::index_t>(i), 0,
                                            neighbors_of(cloud, i), a, b, c);
      Histogram all;
      for (const auto* part : {&a, &b, &c}) {
        for (int k = 0; k < 11; ++k) all.push_back(static_cast<double>((*part)(0, k)));
      }
      simplified_.push_back(all);
    }
  }
  const Histogram& operator[](std::size_t i) const { return simplified_[i]; }

 private:
  pcl::PointCloud<pcl::PointXYZ> points_;
  pcl::PointCloud<pcl::Normal> normals_;
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation_;
  std::vector<Histogram> simplified_;
};

void add(Histogram& sum, double weight, const Histogram& other) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * other[k];
}

Histogram each_part_to_100(Histogram h) {
  for (std::size_t part = 0; part < 33; part += 11) {
    const auto first = h.begin() + static_cast<std::ptrdiff_t>(part);
    const double sum = std::accumulate(first, first + 11, 0.0);
    for (std::size_t k = part; k < part + 11; ++k) h[k] *= sum > 0 ? 100 / sum : 0;
  }
  return h;
}

// Rusu et al. 2009, equation 3: a point's own histogram and the mean of its neighbours', weighted
// by the inverse of their distance; both parts count alike.
Histogram expected_feature(const PointCloud& cloud, const PclHistograms& simplified,
                           std::size_t i) {
  Histogram around(33, 0.0);
  for (const int j : neighbors_of(cloud, i)) {
    const auto k = static_cast<std::size_t>(j);
    const double distance = static_cast<double>((cloud.points[k] - cloud.points[i]).norm());
    if (distance > 0) add(around, 1 / distance, simplified[k]);
  }
  Histogram feature = each_part_to_100(around);
  add(feature, 1, simplified[i]);
  return each_part_to_100(feature);
}

TEST(Fpfh, AgreesWithHistogramsByPcl) {
  const PointCloud cloud = wavy_surface();
  const PclHistograms simplified(cloud);
  std::vector<int> indices(cloud.size());
  std::iota(indices.begin(), indices.end(), 0);
  const auto features = compute_fpfh(cloud, indices, kRadius, 0);
  ASSERT_EQ(features.size(), cloud.size());
  double total = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Histogram expected = expected_feature(cloud, simplified, i);
    double difference = 0;
    for (std::size_t k = 0; k < 33; ++k) difference += std::abs(expected[k] - features[i][k]);
    EXPECT_LT(difference, 6) << "of 300; a pair on the border of two bins moves a few of them";
    total += difference;
  }
  EXPECT_LT(total / static_cast<double>(cloud.size()), 0.5);
}

TEST(Fpfh, EveryPartSumsToAHundred) {
  const PointCloud cloud = wavy_surface();
  const std::vector<int> indices{0, 5, 200, 575};
  for (const Fpfh& feature : compute_fpfh(cloud, indices, kRadius, 1)) {
    for (int part = 0; part < 3; ++part) {
      const auto* first = feature.data() + 11 * part;
      EXPECT_NEAR(std::accumulate(first, first + 11, 0.0f), 100, 1e-3);
    }
  }
}

TEST(Fpfh, AFewIndicesGiveTheSameAsAll) {
  const PointCloud cloud = wavy_surface();
  std::vector<int> all(cloud.size());
  std::iota(all.begin(), all.end(), 0);
  const auto expected = compute_fpfh(cloud, all, kRadius, 1);
  const std::vector<int> some{300, 2, 2, 575, 0};
  for (const int threads : {1, 2, 8}) {
    const auto features = compute_fpfh(cloud, some, kRadius, threads);
    ASSERT_EQ(features.size(), some.size());
    for (std::size_t k = 0; k < some.size(); ++k) {
      EXPECT_EQ(features[k], expected[static_cast<std::size_t>(some[k])]);
    }
  }
}

TEST(Fpfh, OfALonelyPointIsZero) {
  PointCloud cloud;
  cloud.points = {{0, 0, 1}, {1, 0, 1}};
  cloud.normals = {-Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ()};
  const auto features = compute_fpfh(cloud, std::vector<int>{0}, kRadius, 1);
  ASSERT_EQ(features.size(), 1u);
  EXPECT_EQ(features[0], Fpfh{});
  EXPECT_TRUE(compute_fpfh(PointCloud{}, {}, kRadius, 1).empty());
}

TEST(Fpfh, PointsInOnePlaceDoNoHarm) {
  PointCloud cloud = wavy_surface();
  for (int k = 0; k < 5; ++k) {
    cloud.points.push_back(cloud.points[100]);
    cloud.normals.push_back(cloud.normals[100]);
  }
  const auto features = compute_fpfh(cloud, std::vector<int>{100}, kRadius, 1);
  for (const float value : features[0]) EXPECT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace bpa::features
