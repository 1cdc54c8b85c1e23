// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/modeling/registration.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/features/pair_voting.hpp"
#include "core/geometry/pose.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/geometry/symmetry.hpp"
#include "core/model/distance_transform.hpp"

namespace bpa::modeling {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Candidate {
  FastPose motion;
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
    const Eigen::Vector3f d = p - cloud.points[j];
    const bool lies = std::abs(d.dot(cloud.normals[j])) < tolerance &&
                      d.squaredNorm() < 6 * tolerance * tolerance;
    return lies && n.dot(cloud.normals[j]) > 0.7f ? j : -1;
  }
};

// A random part of a cloud.
PointCloud sample_of(const PointCloud& cloud, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<int> chosen(count);
  for (int& i : chosen) i = random.index(static_cast<int>(cloud.size()));
  return select(cloud, chosen);
}

// The share of the sample that lies on the target; gives up where the first points do not.
float check(const PointCloud& sample, const Target& target, const FastPose& motion,
            float tolerance) {
  constexpr std::size_t kFirstLook = 20;
  int on = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    if (i == kFirstLook && on < 5) return 0;
    on += target.partner(motion * sample.points[i], motion.rotation * sample.normals[i],
                         tolerance) >= 0;
  }
  return static_cast<float>(on) / sample.size();
}

// Point-to-plane ICP: each round solves for a small rotation about the middle and a translation.
Registration refine(const PointCloud& source, const Target& target, const FastPose& start,
                    float tolerance) {
  constexpr int kRounds = 25;
  Pose pose = to_pose(start);
  Registration out;
  for (int round = 0; round <= kRounds; ++round) {
    const float reach = round < 8 ? 2 * tolerance : tolerance;
    const FastPose m = to_fast(pose);
    Matrix6 hessian = 1e-9 * Matrix6::Identity();
    Vector6 gradient = Vector6::Zero();
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      const Eigen::Vector3f p = m * source.points[i];
      const int j = target.partner(p, m.rotation * source.normals[i], reach);
      if (j < 0) continue;
      const Eigen::Vector3d n = target.cloud.normals[j].cast<double>();
      const double r = n.dot((p - target.cloud.points[j]).cast<double>());
      Vector6 slope;
      slope << p.cast<double>().cross(n), n;
      hessian += slope * slope.transpose();
      gradient += r * slope;
      squares += r * r;
      ++count;
    }
    out = {pose, count / source.size(), count > 0 ? std::sqrt(squares / count) : 0};
    if (count < 12 || round == kRounds) break;
    const Vector6 step = -solve_symmetric(hessian, gradient);
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
// checks accept many poses: worse ones, which may show its other faces, would find no room.
std::vector<FastPose> best_of_each_kind(const std::vector<Candidate>& candidates, double size) {
  constexpr std::size_t kMost = 1000;
  constexpr int kEachTurn = 6;
  std::vector<FastPose> kept;
  std::vector<Pose> poses;
  for (const Candidate& c : candidates) {
    if (kept.size() >= kMost) break;
    const Pose pose = to_pose(c.motion);
    int turned_alike = 0;
    const bool known = std::ranges::any_of(poses, [&](const Pose& k) {
      turned_alike += rotation_angle(k.rotation, pose.rotation) < 0.6;
      return turned_alike >= kEachTurn || alike(k, pose, 0.2, 0.06 * size);
    });
    if (known) continue;
    kept.push_back(c.motion);
    poses.push_back(pose);
  }
  return kept;
}

// What source and target are compared by: thinned, hashed and sampled.
class PairSearch {
 public:
  PairSearch(const PointCloud& source, const PointCloud& target, const Target& surface,
             const RegistrationOptions& options)
      : surface_(surface),
        target_(target),
        size_(size_of(target)),
        spacing_(thin(size_, target_)),
        source_(downsample(source, spacing_)),
        sample_(sample_of(source, kSampled, options.seed)),
        table_(target_, std::max(0.006f, 0.04f * static_cast<float>(size_))),
        tolerance_(static_cast<float>(std::max(2 * options.tolerance_m, 0.03 * size_))) {}

  double size() const { return size_; }  // of the target's box, metres
  const PointCloud& thinned_source() const { return source_; }

  // Adds the poses that one random pair of the source's points suggests.
  void try_pair(RandomStream& random, std::vector<Candidate>& found) const {
    const int n = static_cast<int>(source_.size());
    const int i = random.index(n);
    const int j = random.index(n);
    const Eigen::Vector3f &p = source_.points[i], &normal = source_.normals[i];
    const features::PointPairFeature f =
        features::point_pair_feature(p, normal, source_.points[j], source_.normals[j]);
    if (f.distance < kShortest || !features::fixes_pose(f)) return;
    const auto entries = table_.lookup(f.distance, features::pair_angle_key(f));
    const Eigen::Matrix3f own = features::basis_of(normal);
    const std::uint8_t turn = features::turn_of(own, source_.points[j] - p);
    const std::size_t stride = entries.size() / kMostEntries + 1;
    for (std::size_t e = 0; e < entries.size(); e += stride) {
      const std::size_t k = entries[e].point;
      const float angle = (entries[e].turn - turn) * (2 * 3.14159265f / features::kTurnSteps);
      Candidate c;
      c.motion.rotation = features::basis_of(target_.normals[k]) *
                          Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitZ()).toRotationMatrix() *
                          own.transpose();
      c.motion.translation = target_.points[k] - c.motion.rotation * p;
      c.score = check(sample_, surface_, c.motion, tolerance_);
      if (c.score > 0) found.push_back(c);
    }
  }

 private:
  static constexpr std::size_t kSampled = 120;     // points that a pose is checked on
  static constexpr std::size_t kMostEntries = 60;  // of the table, tried for one pair
  static constexpr std::size_t kMostPoints = 450;  // of the thinned target
  static constexpr float kShortest = 0.01f;        // of a pair, metres

  static double size_of(const PointCloud& target) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : target.points) box.extend(p);
    return static_cast<double>(box.diagonal().norm());
  }
  // Leaves at most kMostPoints of the cloud; returns the spacing that does.
  static float thin(double size, PointCloud& cloud) {
    float spacing = std::max(0.006f, 0.05f * static_cast<float>(size));
    PointCloud few = downsample(cloud, spacing);
    for (; few.size() > kMostPoints; few = downsample(cloud, spacing)) spacing *= 1.15f;
    cloud = std::move(few);
    return spacing;
  }

  const Target& surface_;
  PointCloud target_;  // thinned
  double size_;
  float spacing_;
  PointCloud source_;  // thinned
  PointCloud sample_;
  features::PointPairTable table_;
  float tolerance_;
};

// Poses of random pairs, best score first. The same for any number of threads.
std::vector<Candidate> candidates_of(const PairSearch& search, const RegistrationOptions& options) {
  constexpr int kPieces = 64;
  std::vector<std::vector<Candidate>> found(kPieces);
  parallel_for(kPieces, options.num_threads, [&](int piece) {
    RandomStream random(options.seed, piece + 1);
    for (int k = piece; k < options.draws; k += kPieces) search.try_pair(random, found[piece]);
  });
  std::vector<Candidate> candidates;
  for (const auto& f : found) candidates.insert(candidates.end(), f.begin(), f.end());
  std::ranges::stable_sort(candidates, std::greater(), &Candidate::score);
  return candidates;
}

// ICP of the source from each of the poses; best overlap first.
std::vector<Registration> refine_all(const PointCloud& source, const Target& target,
                                     const std::vector<FastPose>& starts,
                                     const RegistrationOptions& options) {
  std::vector<Registration> refined(starts.size());
  parallel_for(starts.size(), options.num_threads, [&](std::size_t i) {
    refined[i] = refine(source, target, starts[i], static_cast<float>(options.tolerance_m));
  });
  std::ranges::stable_sort(refined, std::greater(), &Registration::overlap);
  return refined;
}

}  // namespace

std::vector<Registration> register_surfaces(const PointCloud& source, const PointCloud& target,
                                            const RegistrationOptions& options) {
  if (source.size() < 30 || target.size() < 30) return {};
  const Target surface(target);
  const PairSearch search(source, target, surface, options);
  const std::vector<FastPose> starts =
      best_of_each_kind(candidates_of(search, options), search.size());
  // Many come to the same end; the best of each go on with all points.
  std::vector<Pose> ends;
  std::vector<FastPose> fast_ends;
  for (const Registration& r : refine_all(search.thinned_source(), surface, starts, options)) {
    if (static_cast<int>(ends.size()) >= options.kept) break;
    const bool known = std::ranges::any_of(ends, [&](const Pose& end) {
      return alike(end, r.target_from_source, 0.09, 0.015 * search.size());
    });
    if (known) continue;
    ends.push_back(r.target_from_source);
    fast_ends.push_back(to_fast(r.target_from_source));
  }
  return refine_all(source, surface, fast_ends, options);
}

bool same_size(const ModelSource& a, const ModelSource& b) {
  constexpr double kSameSize = 0.04;  // chosen by hand
  return std::abs(b.diameter / a.diameter - 1) <= kSameSize;
}

bool same_shape(const ModelSource& a, const ModelSource& b, int num_threads) {
  constexpr double kSameShape = 0.97;  // chosen by hand
  if (!same_size(a, b)) return false;
  const RegistrationOptions options{.tolerance_m = std::max(0.002, 0.015 * a.diameter),
                                    .draws = 600,
                                    .kept = 4,
                                    .num_threads = num_threads};
  const auto lies_on = [&options](const PointCloud& from, const PointCloud& onto) {
    const auto found = register_surfaces(from, onto, options);
    return !found.empty() && found.front().overlap >= kSameShape;
  };
  return lies_on(a.surface, b.surface) && lies_on(b.surface, a.surface);
}

}  // namespace bpa::modeling
