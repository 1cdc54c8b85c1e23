// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Which plane is the turntable, and what stands on it. Camera and table do not move, but the object
// turns: pixels whose depth changes show it. The table is the plane that carries what changes.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

#include "core/base/random.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa {
namespace {

float noise_of(float depth) { return depth_noise(depth); }

// The scene without the object, as far as it can be seen, and where the object was seen.
struct Background {
  std::vector<Eigen::Vector3f> points, normals;  // of valid pixels
  std::vector<Eigen::Vector3f> moving;           // measured in front of the background
};

Background look_behind(const std::vector<ScanView>& views) {
  Background out;
  const SurfaceMap& first = views.front().view.map;
  std::vector<std::pair<float, std::size_t>> depths;
  for (std::size_t i = 0; i < first.size(); ++i) {
    depths.clear();
    for (std::size_t v = 0; v < views.size(); ++v) {
      const float z = views[v].view.map.depth[i];
      if (z > 0) depths.push_back({z, v});
    }
    if (depths.size() < 2) continue;
    std::sort(depths.begin(), depths.end());
    // Neither the farthest nor nearest measurement is to be trusted.
    const auto far_place =
        depths.begin() + static_cast<std::ptrdiff_t>(0.85 * static_cast<double>(depths.size() - 1));
    const SurfaceMap& map = views[far_place->second].view.map;
    const float far = far_place->first;
    if (map.normals[i].squaredNorm() > 0.5f) {
      out.points.push_back(map.points[i]);
      out.normals.push_back(map.normals[i]);
    }
    const float least = std::max(0.015f, 8 * noise_of(far));
    // Ragged edges of what does not move change too: take what is seen to come and go repeatedly.
    if (depths.size() >= 3 && depths[1].first < far - least) {
      for (const auto& [z, v] : depths) {
        if (z < far - least) out.moving.push_back(views[v].view.map.points[i]);
      }
    }
  }
  return out;
}

bool on_plane(const Plane& plane, const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
  const float tolerance = std::max(0.005f, 2.5f * noise_of(p.z()));
  return std::abs(plane.normal.dot(p) - plane.offset) < tolerance && plane.normal.dot(n) > 0.94f;
}

Plane refit(const Plane& start, const std::vector<Eigen::Vector3f>& points,
            const std::vector<Eigen::Vector3f>& normals) {
  Plane plane = start;
  for (int round = 0; round < 3; ++round) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!on_plane(plane, points[i], normals[i])) continue;
      const Eigen::Vector3d p = points[i].cast<double>();
      mean += p;
      squares += p * p.transpose();
      ++count;
    }
    if (count < 10) return plane;
    mean /= count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / count -
                                                                mean * mean.transpose());
    Eigen::Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(mean) > 0) normal = -normal;  // toward the camera
    plane = {normal.cast<float>(), static_cast<float>(normal.dot(mean))};
  }
  return plane;
}

// The largest planes of the background, one after the other, by RANSAC.
std::vector<Plane> find_planes(const Background& background, std::uint64_t seed) {
  constexpr int kPlanes = 8, kDraws = 200;
  constexpr std::size_t kLeast = 400;  // pixels
  std::vector<Eigen::Vector3f> points = background.points, normals = background.normals;
  std::vector<Plane> planes;
  for (int k = 0; k < kPlanes && points.size() >= kLeast; ++k) {
    RandomStream random(seed, static_cast<std::uint64_t>(k));
    Plane best;
    int best_count = 0;
    const std::size_t step = std::max<std::size_t>(1, points.size() / 4000);
    for (int draw = 0; draw < kDraws; ++draw) {
      const auto i = static_cast<std::size_t>(random.index(static_cast<int>(points.size())));
      const Plane plane{normals[i], normals[i].dot(points[i])};
      int count = 0;
      for (std::size_t j = 0; j < points.size(); j += step) {
        count += on_plane(plane, points[j], normals[j]);
      }
      if (count <= best_count) continue;
      best_count = count;
      best = plane;
    }
    if (static_cast<std::size_t>(best_count) * step < kLeast) break;
    best = refit(best, points, normals);
    std::vector<Eigen::Vector3f> rest_points, rest_normals;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (on_plane(best, points[j], normals[j])) continue;
      rest_points.push_back(points[j]);
      rest_normals.push_back(normals[j]);
    }
    points = std::move(rest_points);
    normals = std::move(rest_normals);
    planes.push_back(best);
  }
  return planes;
}

float height(const Plane& plane, const Eigen::Vector3f& p) {
  return plane.normal.dot(p) - plane.offset;
}

bool near_plane(const std::vector<Plane>& planes, const Eigen::Vector3f& p) {
  return std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
    return std::abs(height(plane, p)) < std::max(0.006f, 3 * noise_of(p.z()));
  });
}

// The plane that carries the points: nearly all are above it, and none is nearer to them.
const Plane* carrier(const std::vector<Plane>& planes, const std::vector<Eigen::Vector3f>& points) {
  constexpr float kMostGap = 0.05f;  // the lowest part may be out of sight
  const Plane* best = nullptr;
  float lowest = kMostGap;
  for (const Plane& plane : planes) {
    std::vector<float> heights;
    for (const Eigen::Vector3f& p : points) heights.push_back(height(plane, p));
    const auto quantile = [&heights](double q) {
      const auto place = heights.begin() +
                         static_cast<std::ptrdiff_t>(q * static_cast<double>(heights.size() - 1));
      std::nth_element(heights.begin(), place, heights.end());
      return *place;
    };
    if (quantile(0.02) < -0.006f) continue;
    const float gap = quantile(0.08);
    if (gap >= lowest) continue;
    lowest = gap;
    best = &plane;
  }
  return best;
}

// Whether what the camera sees of a plane lies all round a place on it, beyond a radius.
bool surrounds(const Plane& plane, const Background& background, const Eigen::Vector3f& middle,
               float radius) {
  constexpr int kSectors = 8, kLeast = 10;  // the object may hide what is behind it
  const Eigen::Vector3f x = plane.normal.unitOrthogonal(), y = plane.normal.cross(x);
  std::array<int, kSectors> count{};
  for (std::size_t i = 0; i < background.points.size(); ++i) {
    const Eigen::Vector3f d = background.points[i] - middle;
    const float u = d.dot(x), v = d.dot(y);
    if (u * u + v * v < radius * radius) continue;
    if (!on_plane(plane, background.points[i], background.normals[i])) continue;
    const double turn = std::atan2(v, u) / (2 * M_PI) + 0.5;
    ++count[static_cast<std::size_t>(turn * kSectors) % kSectors];
  }
  return std::count_if(count.begin(), count.end(), [](int c) { return c >= kLeast; }) >=
         kSectors - 1;
}

// The same where little but ragged edges changes: the object looks alike from all sides, and so
// does a turning plate on a table, whose rim is below its top. Of the planes with most of the
// points in their midst, the highest.
const Plane* highest_carrier(const std::vector<Plane>& planes, const Background& background,
                             const std::vector<Eigen::Vector3f>& points) {
  constexpr float kMostGap = 0.05f, kLeastHeight = 0.006f, kMostHeight = 0.6f;
  const Plane* best = nullptr;
  for (const Plane& plane : planes) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    std::vector<Eigen::Vector3f> feet;
    bool stands = false;
    for (const Eigen::Vector3f& p : points) {
      const float h = height(plane, p);
      if (h < kLeastHeight || h > kMostHeight) continue;
      feet.emplace_back(p - h * plane.normal);
      middle += feet.back();
      stands |= h < kMostGap;
    }
    if (2 * feet.size() < points.size() || !stands) continue;
    middle /= static_cast<float>(feet.size());
    std::vector<float> squared;
    for (const Eigen::Vector3f& p : feet) squared.push_back((p - middle).squaredNorm());
    const auto half = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
    std::nth_element(squared.begin(), half, squared.end());
    if (!surrounds(plane, background, middle, std::sqrt(*half))) continue;
    if (best == nullptr || height(*best, middle) > 0) best = &plane;
  }
  return best;
}

// Where the ray through a point meets the first plane, is it above the second?
bool is_above(const Plane& plane, const Plane& other, const Eigen::Vector3f& p) {
  return height(other, p * (plane.offset / plane.normal.dot(p))) > 0;
}

// What an object that looks the same from all sides shows: whatever rises above a plane near the
// middle of the image and belongs to no plane.
std::vector<Eigen::Vector3f> standing_in_the_middle(const Background& background,
                                                    const std::vector<Plane>& planes) {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < background.points.size(); ++i) {
    const Eigen::Vector3f& p = background.points[i];
    if (std::max(std::abs(p.x()), std::abs(p.y())) > 0.2f * p.z()) continue;
    if (!near_plane(planes, p)) points.push_back(p);
  }
  return points;
}

// The ground covered by what rises above the plane, in cells of a centimetre.
class Footprint {
 public:
  Footprint(const Plane& plane, const Eigen::Vector3f& origin) : origin_(origin) {
    x_ = plane.normal.unitOrthogonal();
    y_ = plane.normal.cross(x_);
    cells_.assign(kSide * kSide, 0);
  }

  int cell_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f d = p - origin_;
    const int u = static_cast<int>(std::floor(d.dot(x_) / kCell)) + kSide / 2;
    const int v = static_cast<int>(std::floor(d.dot(y_) / kCell)) + kSide / 2;
    return u < 0 || v < 0 || u >= kSide || v >= kSide ? -1 : v * kSide + u;
  }
  void count(const Eigen::Vector3f& p) {
    if (const int c = cell_of(p); c >= 0) ++cells_[static_cast<std::size_t>(c)];
  }
  bool belongs(const Eigen::Vector3f& p) const {
    const int c = cell_of(p);
    return c >= 0 && object_[static_cast<std::size_t>(c)];
  }

  // Everything connected with the cells of the seeds, over gaps of a cell.
  void grow(const std::vector<Eigen::Vector3f>& seeds, int least) {
    object_.assign(cells_.size(), 0);
    std::vector<int> votes(cells_.size(), 0);
    for (const Eigen::Vector3f& p : seeds) {
      if (const int c = cell_of(p); c >= 0) ++votes[static_cast<std::size_t>(c)];
    }
    std::queue<int> open;
    const int most = *std::max_element(votes.begin(), votes.end());
    for (std::size_t c = 0; c < votes.size(); ++c) {
      if (4 * votes[c] < most || cells_[c] < least) continue;
      object_[c] = 1;
      open.push(static_cast<int>(c));
    }
    while (!open.empty()) {
      const int c = open.front();
      open.pop();
      for (int dv = -2; dv <= 2; ++dv) {
        for (int du = -2; du <= 2; ++du) {
          const int u = c % kSide + du, v = c / kSide + dv;
          if (u < 0 || v < 0 || u >= kSide || v >= kSide) continue;
          const auto n = static_cast<std::size_t>(v * kSide + u);
          if (object_[n] || cells_[n] < least) continue;
          object_[n] = 1;
          open.push(static_cast<int>(n));
        }
      }
    }
  }

 private:
  static constexpr int kSide = 160;
  static constexpr float kCell = 0.01f;
  Eigen::Vector3f origin_, x_, y_;
  std::vector<int> cells_;
  std::vector<std::uint8_t> object_;
};

}  // namespace

Result<Plane> segment_object(std::vector<ScanView>& views, const ScanOptions& options) {
  constexpr std::size_t kEnough = 300;  // pixels over all views
  const Background background = look_behind(views);
  const std::vector<Plane> planes = find_planes(background, options.seed);
  if (planes.empty()) return Status(StatusCode::not_found, "no plane of a turntable was found");
  // At ragged edges of what does not move, depth changes too; but that lies on a plane.
  std::vector<Eigen::Vector3f> standing;
  for (const Eigen::Vector3f& p : background.moving) {
    if (!near_plane(planes, p)) standing.push_back(p);
  }
  const bool turns = standing.size() >= kEnough;
  if (!turns) standing = standing_in_the_middle(background, planes);
  const Status empty(StatusCode::not_found, "nothing stands on the turntable, in none of the " +
                                                std::to_string(views.size()) + " views");
  if (standing.size() < kEnough) return empty;
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& p : standing) middle += p / static_cast<float>(standing.size());
  const Plane* table = highest_carrier(planes, background, standing);
  if (const Plane* lowest = turns ? carrier(planes, standing) : nullptr;
      lowest != nullptr && (table == nullptr || !is_above(*table, *lowest, middle))) {
    table = lowest;
  }
  if (table == nullptr) return empty;

  Footprint footprint(*table, middle);
  const auto rises = [&](const SurfaceMap& map, std::size_t i) {
    const float h = map.depth[i] > 0 ? height(*table, map.points[i]) : 0;
    return h > std::max(0.004f, 2.7f * noise_of(map.depth[i])) &&
           h < static_cast<float>(options.max_height_m);
  };
  for (const ScanView& scan : views) {
    for (std::size_t i = 0; i < scan.view.map.size(); ++i) {
      if (rises(scan.view.map, i)) footprint.count(scan.view.map.points[i]);
    }
  }
  footprint.grow(standing, std::max(3, static_cast<int>(views.size() / 3)));
  for (ScanView& scan : views) {
    const SurfaceMap& map = scan.view.map;
    for (std::size_t i = 0; i < map.size(); ++i) {
      scan.view.object[i] = rises(map, i) && footprint.belongs(map.points[i]);
    }
  }
  return *table;
}

}  // namespace bpa
