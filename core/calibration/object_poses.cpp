// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/calibration/object_poses.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/base/concat.hpp"

namespace bpa::calibration {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Objects of two cameras this near are one. Chosen by hand.
constexpr double kTogether_m = 0.03, kTogether_rad = 15 * std::numbers::pi / 180;
// Elements of an axis of revolution that are guessed: 10 degrees apart.
constexpr int kTurns = 36;
constexpr int kFewestObjects = 2;  // one alone may be a false positive

struct Known {
  const Placement* placement;
  Pose scene_from_object;
  Matrix6d information;  // scene axes
};

// Two placements of one object: in the fixed frame, and of the camera that is looked for.
struct SamePair {
  const Known* known;
  const Placement* seen;
};

Matrix6d turned_axes(const Eigen::Matrix3d& rotation) {
  Matrix6d out = Matrix6d::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = rotation;
  return out;
}

// A placement without a covariance is off by this much.
Matrix6d covariance_of(const Placement& placement) {
  if (!placement.covariance.isZero()) return placement.covariance;
  constexpr double kSigma_m = 0.005, kSigma_rad = 0.05;
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(kSigma_m * kSigma_m),
      Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
  return variances.asDiagonal();
}

// Several known cameras may see one object.
std::set<const Placement*> objects_of(const std::vector<SamePair>& pairs) {
  std::set<const Placement*> out;
  for (const SamePair& pair : pairs) out.insert(pair.seen);
  return out;
}

class Solver {
 public:
  Solver(std::span<const std::vector<SeenObjects>> moments,
         const std::function<SymmetryGroup(const std::string&)>& symmetry_of)
      : moments_(moments), known_(moments.size()) {
    for (const auto& cameras : moments) {
      for (const SeenObjects& seen : cameras) {
        for (const Placement& placement : seen) {
          if (!symmetries_.contains(placement.model)) {
            symmetries_[placement.model] = symmetry_of(placement.model);
          }
        }
      }
    }
  }

  void add_known(std::size_t camera, const Pose& scene_from_camera) {
    const Matrix6d turn = turned_axes(scene_from_camera.matrix());
    for (std::size_t m = 0; m < moments_.size(); ++m) {
      for (const Placement& placement : moments_[m][camera]) {
        known_[m].push_back({&placement, scene_from_camera * placement.frame_from_object,
                             (turn * covariance_of(placement) * turn.transpose()).inverse()});
      }
    }
  }

  CameraByObjects solve(std::size_t camera) const {
    Pose best;
    std::size_t most = 0;
    double least = 0;
    for (std::size_t m = 0; m < moments_.size(); ++m) {
      for (const Placement& seen : moments_[m][camera]) {
        for (const Known& known : known_[m]) {
          if (known.placement->model != seen.model) continue;
          const SymmetryGroup& symmetry = symmetries_.at(seen.model);
          for (const Pose& element : sampled_elements(symmetry, kTurns)) {
            const Pose guess = known.scene_from_object * element * seen.frame_from_object.inverse();
            const std::vector<SamePair> pairs = together(camera, guess);
            const std::size_t objects = objects_of(pairs).size();
            const double cost = mean_cost(pairs, guess);
            if (objects < most || (objects == most && cost >= least)) continue;
            most = objects;
            least = cost;
            best = guess;
          }
        }
      }
    }
    return refined(camera, best);
  }

 private:
  // The pairs that a camera's pose brings together, one to one: the nearest first.
  std::vector<SamePair> together(std::size_t camera, const Pose& scene_from_camera) const {
    struct Possible {
      double cost;
      SamePair pair;
    };
    std::vector<SamePair> out;
    for (std::size_t m = 0; m < moments_.size(); ++m) {
      std::vector<Possible> possible;
      for (const Placement& seen : moments_[m][camera]) {
        for (const Known& known : known_[m]) {
          if (known.placement->model != seen.model) continue;
          const double cost = relative_error({&known, &seen}, scene_from_camera);
          if (cost <= 1) possible.push_back({cost, {&known, &seen}});
        }
      }
      std::ranges::stable_sort(possible, {}, &Possible::cost);
      const std::size_t first = out.size();
      for (const Possible& p : possible) {
        // Several known cameras may see one object: each of theirs is a pair.
        const bool taken =
            std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                        [&](const SamePair& pair) { return pair.known == p.pair.known; });
        if (!taken) out.push_back(p.pair);
      }
    }
    return out;
  }

  PoseError error_of(const SamePair& pair, const Pose& scene_from_camera) const {
    return pose_error(scene_from_camera * pair.seen->frame_from_object,
                      pair.known->scene_from_object, symmetries_.at(pair.seen->model), kTogether_m,
                      kTogether_rad);
  }
  // 1 at the limits of what is together.
  double relative_error(const SamePair& pair, const Pose& scene_from_camera) const {
    const Eigen::Vector3d offset = scene_from_camera * pair.seen->frame_from_object.translation -
                                   pair.known->scene_from_object.translation;
    constexpr double kFar = 0.3;  // metres, whatever the symmetry
    if (offset.norm() > kFar) return 2;
    const PoseError error = error_of(pair, scene_from_camera);
    return std::max(error.position / kTogether_m, error.angle / kTogether_rad);
  }
  double mean_cost(const std::vector<SamePair>& pairs, const Pose& scene_from_camera) const {
    double sum = 0;
    for (const SamePair& pair : pairs) sum += relative_error(pair, scene_from_camera);
    return sum / std::max<double>(1, static_cast<double>(pairs.size()));
  }

  // Gauss-Newton on offsets of poses; unknowns are the camera's translation and its rotation about
  // the fixed frame's origin.
  CameraByObjects refined(std::size_t camera, Pose pose) const {
    constexpr int kIterations = 10;
    for (int k = 0; k < kIterations; ++k) {
      Matrix6d information = Matrix6d::Zero();
      Vector6d gradient = Vector6d::Zero();
      const Matrix6d turn = turned_axes(pose.matrix());
      for (const SamePair& pair : together(camera, pose)) {
        const Pose known = pair.known->scene_from_object;
        const Pose seen = nearest_symmetric_pose(pose * pair.seen->frame_from_object, known,
                                                 symmetries_.at(pair.seen->model));
        const Matrix6d weight = (turn * covariance_of(*pair.seen) * turn.transpose() +
                                 pair.known->information.inverse())
                                    .inverse();
        Vector6d residual;
        residual << seen.translation - known.translation,
            vector_from_rotation(seen.rotation * known.rotation.conjugate());
        // Huber: an object beyond three standard deviations pulls no harder.
        constexpr double kDeviations = 3;
        const double length = std::sqrt(residual.dot(weight * residual));
        const double robust = length > kDeviations ? kDeviations / length : 1;
        Matrix6d jacobian = Matrix6d::Identity();
        const Eigen::Vector3d& t = seen.translation;
        jacobian.topRightCorner<3, 3>() << 0, t.z(), -t.y(), -t.z(), 0, t.x(), t.y(), -t.x(), 0;
        information += robust * jacobian.transpose() * weight * jacobian;
        gradient += robust * jacobian.transpose() * weight * residual;
      }
      const Vector6d step = -information.ldlt().solve(gradient);
      if (!step.allFinite()) break;
      pose = Pose{rotation_from_vector(step.tail<3>()), step.head<3>()} * pose;
    }
    CameraByObjects out{.scene_from_camera = pose};
    const std::vector<SamePair> pairs = together(camera, pose);
    for (const SamePair& pair : pairs) {
      const PoseError error = error_of(pair, pose);
      out.position_m += error.position * error.position;
      out.angle_rad += error.angle * error.angle;
    }
    const double count = std::max<double>(1, static_cast<double>(pairs.size()));
    out.objects = static_cast<int>(objects_of(pairs).size());
    out.position_m = std::sqrt(out.position_m / count);
    out.angle_rad = std::sqrt(out.angle_rad / count);
    return out;
  }

  std::span<const std::vector<SeenObjects>> moments_;
  std::vector<std::vector<Known>> known_;  // of each moment
  std::map<std::string, SymmetryGroup> symmetries_;
};

}  // namespace

Result<std::vector<CameraByObjects>> cameras_from_objects(
    std::span<const std::vector<SeenObjects>> moments,
    const std::function<SymmetryGroup(const std::string& model)>& symmetry_of, const Pose& first) {
  const std::size_t cameras = moments.empty() ? 0 : moments.front().size();
  if (cameras < 2) {
    return invalid_argument("there are ", cameras, " cameras; there must be at least 2");
  }
  for (const auto& moment : moments) {
    if (moment.size() == cameras) continue;
    return invalid_argument("a moment has ", moment.size(), " cameras, another ", cameras);
  }
  Solver solver(moments, symmetry_of);
  std::vector<CameraByObjects> out(cameras);
  std::vector<bool> done(cameras, false);
  out[0].scene_from_camera = first;
  done[0] = true;
  solver.add_known(0, first);
  for (std::size_t left = cameras - 1; left > 0; --left) {
    std::size_t best = 0;
    for (std::size_t c = 1; c < cameras; ++c) {
      if (done[c]) continue;
      out[c] = solver.solve(c);
      if (best == 0 || out[c].objects > out[best].objects) best = c;
    }
    if (out[best].objects < kFewestObjects) {
      return not_found("camera ", best, " sees ", out[best].objects,
                       " objects where other cameras see them; at least ", kFewestObjects,
                       " are needed");
    }
    done[best] = true;
    solver.add_known(best, out[best].scene_from_camera);
  }
  return out;
}

}  // namespace bpa::calibration
