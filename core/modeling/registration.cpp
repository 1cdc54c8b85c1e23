// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/features/point_pairs.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/model/distance_transform.hpp"

namespace bpa {
namespace {

struct Motion {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f translation = Eigen::Vector3f::Zero();
};

struct Candidate {
  Motion motion;
  float score = 0;
};

// A surface that others are laid onto.
struct Target {
  const PointCloud& cloud;
  DistanceTransform distances;

  explicit Target(const PointCloud& c)
      : cloud(c), distances(distance_transform(c.points, 0.003f, 0.02f)) {}

  // The point on which another would lie; -1 if none faces the same way within the tolerance.
  int partner(const Eigen::Vector3f& p, const Eigen::Vector3f& n, float tolerance) const {
    const int j = distances.nearest_to(p);
    if (j < 0) return -1;
    const auto k = static_cast<std::size_t>(j);
    const Eigen::Vector3f d = p - cloud.points[k];
    const bool lies = std::abs(d.dot(cloud.normals[k])) < tolerance &&
                      d.squaredNorm() < 6 * tolerance * tolerance;
    return lies && n.dot(cloud.normals[k]) > 0.7f ? j : -1;
  }
};

// A random part of a cloud.
PointCloud sample_of(const PointCloud& cloud, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  PointCloud out;
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(random.index(static_cast<int>(cloud.size())));
    out.points.push_back(cloud.points[i]);
    out.normals.push_back(cloud.normals[i]);
  }
  return out;
}

// The share of the sample that lies on the target; gives up where the first points do not.
float check(const PointCloud& sample, const Target& target, const Motion& motion, float tolerance) {
  constexpr std::size_t kFirstLook = 20;
  int on = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    if (i == kFirstLook && on < 5) return 0;
    on += target.partner(motion.rotation * sample.points[i] + motion.translation,
                         motion.rotation * sample.normals[i], tolerance) >= 0;
  }
  return static_cast<float>(on) / static_cast<float>(sample.size());
}

Pose to_pose(const Motion& m) {
  return Pose::from_matrix(m.rotation.cast<double>(), m.translation.cast<double>());
}

Motion to_motion(const Pose& pose) {
  return {pose.matrix().cast<float>(), pose.translation.cast<float>()};
}

// Point-to-plane ICP: each round solves for a small rotation about the middle and a translation.
Registration refine(const PointCloud& source, const Target& target, const Motion& start,
                    float tolerance) {
  constexpr int kRounds = 25;
  Pose pose = to_pose(start);
  Registration out;
  for (int round = 0; round <= kRounds; ++round) {
    const float reach = round < 8 ? 2 * tolerance : tolerance;
    const Motion m = to_motion(pose);
    Eigen::Matrix<double, 6, 6> hessian = 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      const Eigen::Vector3f p = m.rotation * source.points[i] + m.translation;
      const int j = target.partner(p, m.rotation * source.normals[i], reach);
      if (j < 0) continue;
      const Eigen::Vector3d n = target.cloud.normals[static_cast<std::size_t>(j)].cast<double>();
      const double r = n.dot((p - target.cloud.points[static_cast<std::size_t>(j)]).cast<double>());
      Eigen::Matrix<double, 6, 1> slope;
      slope << p.cast<double>().cross(n), n;
      hessian += slope * slope.transpose();
      gradient += r * slope;
      squares += r * r;
      ++count;
    }
    out = {pose, count / static_cast<double>(source.size()),
           count > 0 ? std::sqrt(squares / count) : 0};
    if (count < 12 || round == kRounds) break;
    const Eigen::Matrix<double, 6, 1> step = -hessian.ldlt().solve(gradient);
    const Pose change{rotation_from_vector(step.head<3>()), step.tail<3>()};
    pose = change * pose;
    if (round > 8 && step.head<3>().norm() < 1e-5 && step.tail<3>().norm() < 1e-6) break;
  }
  return out;
}

bool alike(const Pose& a, const Pose& b, double angle, double distance) {
  return rotation_angle(a.rotation, b.rotation) < angle &&
         (a.translation - b.translation).norm() < distance;
}

// From candidates by falling score, the best few of each way to turn: of a box laid onto itself the
// checks accept so many poses that worse ways, which may show its other faces, would find no room.
std::vector<Candidate> best_of_each_kind(const std::vector<Candidate>& candidates, double size) {
  constexpr std::size_t kMost = 1000;
  constexpr int kEachTurn = 6;
  std::vector<Candidate> kept;
  std::vector<Pose> poses;
  for (const Candidate& c : candidates) {
    if (kept.size() >= kMost) break;
    const Pose pose = to_pose(c.motion);
    int turned_alike = 0;
    const bool known = std::any_of(poses.begin(), poses.end(), [&](const Pose& k) {
      turned_alike += rotation_angle(k.rotation, pose.rotation) < 0.6;
      return turned_alike >= kEachTurn || alike(k, pose, 0.2, 0.06 * size);
    });
    if (known) continue;
    kept.push_back(c);
    poses.push_back(pose);
  }
  return kept;
}

// The poses that one random pair of the source's points suggests.
void try_pair(const PointCloud& source, const PointCloud& target, const PointPairTable& table,
              const PointCloud& sample, const Target& surface, float tolerance,
              RandomStream& random, std::vector<Candidate>& found) {
  constexpr std::size_t kMostEntries = 60;
  const int n = static_cast<int>(source.size());
  const auto i = static_cast<std::size_t>(random.index(n));
  const auto j = static_cast<std::size_t>(random.index(n));
  const PointPairFeature f =
      point_pair_feature(source.points[i], source.normals[i], source.points[j], source.normals[j]);
  if (f.distance < 0.01f || !fixes_pose(f)) return;
  const auto entries = table.lookup(f.distance, pair_angle_key(f));
  const Eigen::Matrix3f own = basis_of(source.normals[i]);
  const std::uint8_t turn = turn_of(own, source.points[j] - source.points[i]);
  const std::size_t stride = entries.size() / kMostEntries + 1;
  for (std::size_t e = 0; e < entries.size(); e += stride) {
    const float angle = static_cast<float>(static_cast<int>(entries[e].turn) - turn) *
                        (2 * 3.14159265f / kTurnSteps);
    const Eigen::Matrix3f basis = basis_of(target.normals[entries[e].point]);
    Candidate c;
    c.motion.rotation = basis *
                        Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitZ()).toRotationMatrix() *
                        own.transpose();
    c.motion.translation = target.points[entries[e].point] - c.motion.rotation * source.points[i];
    c.score = check(sample, surface, c.motion, tolerance);
    if (c.score > 0) found.push_back(c);
  }
}

}  // namespace

std::vector<Registration> register_surfaces(const PointCloud& source, const PointCloud& target,
                                            const RegistrationOptions& options) {
  if (source.size() < 30 || target.size() < 30) return {};
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : target.points) box.extend(p);
  const double size = static_cast<double>(box.diagonal().norm());
  float spacing = std::max(0.006f, 0.05f * static_cast<float>(size));
  PointCloud few = downsample(target, spacing);
  for (; few.size() > 450; few = downsample(target, spacing)) spacing *= 1.15f;
  const PointPairTable table(few, std::max(0.006f, 0.04f * static_cast<float>(size)));
  const Target surface(target);
  const PointCloud from = downsample(source, spacing);
  const PointCloud sample = sample_of(source, 120, options.seed);
  const auto rough = static_cast<float>(std::max(2 * options.tolerance_m, 0.03 * size));

  constexpr int kPieces = 64;
  std::vector<std::vector<Candidate>> found(kPieces);
  parallel_for(kPieces, options.num_threads, [&](int piece) {
    RandomStream random(options.seed, static_cast<std::uint64_t>(piece) + 1);
    auto& own = found[static_cast<std::size_t>(piece)];
    for (int k = piece; k < options.draws; k += kPieces) {
      try_pair(from, few, table, sample, surface, rough, random, own);
    }
  });
  std::vector<Candidate> candidates;
  for (const auto& f : found) candidates.insert(candidates.end(), f.begin(), f.end());
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  const std::vector<Candidate> kept = best_of_each_kind(candidates, size);
  std::vector<Registration> refined(kept.size());
  parallel_for(static_cast<int>(kept.size()), options.num_threads, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    refined[i] = refine(from, surface, kept[i].motion, static_cast<float>(options.tolerance_m));
  });
  std::stable_sort(
      refined.begin(), refined.end(),
      [](const Registration& a, const Registration& b) { return a.overlap > b.overlap; });
  // Many came to the same end.
  std::vector<Registration> ends;
  for (const Registration& r : refined) {
    if (static_cast<int>(ends.size()) >= options.kept) break;
    const bool known = std::any_of(ends.begin(), ends.end(), [&](const Registration& e) {
      return alike(e.target_from_source, r.target_from_source, 0.09, 0.015 * size);
    });
    if (!known) ends.push_back(r);
  }
  refined = std::move(ends);
  parallel_for(static_cast<int>(refined.size()), options.num_threads, [&](int k) {
    Registration& r = refined[static_cast<std::size_t>(k)];
    r = refine(source, surface, to_motion(r.target_from_source),
               static_cast<float>(options.tolerance_m));
  });
  std::stable_sort(
      refined.begin(), refined.end(),
      [](const Registration& a, const Registration& b) { return a.overlap > b.overlap; });
  return refined;
}

}  // namespace bpa
