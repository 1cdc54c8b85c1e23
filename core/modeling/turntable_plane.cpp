// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Which plane is the turntable, and what stands on it. Camera and table do not move, but the object
// turns: pixels whose depth changes show it. The table is the plane that carries what changes.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/base/median.hpp"
#include "core/base/random.hpp"
#include "core/modeling/turntable.hpp"

namespace bpa::modeling {
namespace {

// The scene without the object, as far as it can be seen, and where the object was seen.
struct Background {
  PointCloud still;                     // of valid pixels
  std::vector<Eigen::Vector3f> moving;  // measured in front of it
};

// The value that a share `q` of the values lies below.
template <class Value>
Value quantile(std::vector<Value>& values, double q) {
  const auto place = values.begin() + static_cast<int>(q * (values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

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
    const auto [far, far_view] = depths[static_cast<std::size_t>(0.85 * (depths.size() - 1))];
    const SurfaceMap& map = views[far_view].view.map;
    if (map.normals[i].squaredNorm() > 0.5f) {
      out.still.points.push_back(map.points[i]);
      out.still.normals.push_back(map.normals[i]);
    }
    const float least = std::max(0.015f, 8 * depth_noise(far));
    // Ragged edges of what does not move change too: take what is seen to come and go repeatedly.
    if (depths.size() >= 3 && depths[1].first < far - least) {
      for (const auto& [z, v] : depths) {
        if (z < far - least) out.moving.push_back(views[v].view.map.points[i]);
      }
    }
  }
  return out;
}

bool on_plane(const Plane& plane, const PointCloud& cloud, std::size_t i) {
  const float tolerance = std::max(0.005f, 2.5f * depth_noise(cloud.points[i].z()));
  return std::abs(plane.height(cloud.points[i])) < tolerance &&
         plane.normal.dot(cloud.normals[i]) > 0.94f;
}

Plane refit(const Plane& start, const PointCloud& cloud) {
  Plane plane = start;
  for (int round = 0; round < 3; ++round) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double count = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (!on_plane(plane, cloud, i)) continue;
      const Eigen::Vector3d p = cloud.points[i].cast<double>();
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
  PointCloud rest = background.still;
  std::vector<Plane> planes;
  for (int k = 0; k < kPlanes && rest.size() >= kLeast; ++k) {
    RandomStream random(seed, k);
    Plane best;
    std::size_t best_count = 0;
    const std::size_t step = std::max<std::size_t>(1, rest.size() / 4000);
    for (int draw = 0; draw < kDraws; ++draw) {
      const int i = random.index(static_cast<int>(rest.size()));
      const Plane plane{rest.normals[i], rest.normals[i].dot(rest.points[i])};
      std::size_t count = 0;
      for (std::size_t j = 0; j < rest.size(); j += step) count += on_plane(plane, rest, j);
      if (count <= best_count) continue;
      best_count = count;
      best = plane;
    }
    if (best_count * step < kLeast) break;
    planes.push_back(refit(best, rest));
    rest = select(rest, [&](int j) { return !on_plane(planes.back(), rest, j); });
  }
  return planes;
}

bool near_plane(const std::vector<Plane>& planes, const Eigen::Vector3f& p) {
  return std::ranges::any_of(planes, [&](const Plane& plane) {
    return std::abs(plane.height(p)) < std::max(0.006f, 3 * depth_noise(p.z()));
  });
}

// The plane that carries the points: nearly all are above it, and none is nearer to them.
const Plane* carrier(const std::vector<Plane>& planes, const std::vector<Eigen::Vector3f>& points) {
  constexpr float kMostGap = 0.05f;  // the lowest part may be out of sight
  const Plane* best = nullptr;
  float lowest = kMostGap;
  for (const Plane& plane : planes) {
    std::vector<float> heights;
    for (const Eigen::Vector3f& p : points) heights.push_back(plane.height(p));
    if (quantile(heights, 0.02) < -0.006f) continue;
    const float gap = quantile(heights, 0.08);
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
  for (std::size_t i = 0; i < background.still.size(); ++i) {
    const Eigen::Vector3f d = background.still.points[i] - middle;
    const float u = d.dot(x), v = d.dot(y);
    if (u * u + v * v < radius * radius || !on_plane(plane, background.still, i)) continue;
    const double turn = std::atan2(v, u) / (2 * M_PI) + 0.5;
    ++count[static_cast<std::size_t>(turn * kSectors) % kSectors];
  }
  return std::ranges::count_if(count, [](int c) { return c >= kLeast; }) >= kSectors - 1;
}

// The same where only ragged edges change: the object looks alike from all sides, as does a turning
// plate on a table, rim below its top. The highest plane with most of the points in its midst.
const Plane* highest_carrier(const std::vector<Plane>& planes, const Background& background,
                             const std::vector<Eigen::Vector3f>& points) {
  constexpr float kMostGap = 0.05f, kLeastHeight = 0.006f, kMostHeight = 0.6f;
  const Plane* best = nullptr;
  for (const Plane& plane : planes) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    std::vector<Eigen::Vector3f> feet;
    bool stands = false;
    for (const Eigen::Vector3f& p : points) {
      const float h = plane.height(p);
      if (h < kLeastHeight || h > kMostHeight) continue;
      feet.emplace_back(p - h * plane.normal);
      middle += feet.back();
      stands |= h < kMostGap;
    }
    if (2 * feet.size() < points.size() || !stands) continue;
    middle /= feet.size();
    std::vector<float> squared;
    for (const Eigen::Vector3f& p : feet) squared.push_back((p - middle).squaredNorm());
    if (!surrounds(plane, background, middle, std::sqrt(median(squared)))) continue;
    if (best == nullptr || best->height(middle) > 0) best = &plane;
  }
  return best;
}

// Where the ray through a point meets the first plane, is it above the second?
bool is_above(const Plane& plane, const Plane& other, const Eigen::Vector3f& p) {
  return other.height(p * (plane.offset / plane.normal.dot(p))) > 0;
}

// For an object that looks alike from all sides: what is on no plane near the image's middle.
std::vector<Eigen::Vector3f> standing_in_the_middle(const Background& background,
                                                    const std::vector<Plane>& planes) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3f& p : background.still.points) {
    if (std::max(std::abs(p.x()), std::abs(p.y())) > 0.2f * p.z()) continue;
    if (!near_plane(planes, p)) points.push_back(p);
  }
  return points;
}

// The ground covered by what rises above the plane, in cells of a centimetre.
class Footprint {
 public:
  Footprint(const Plane& plane, const Eigen::Vector3f& origin)
      : origin_(origin), x_(plane.normal.unitOrthogonal()), y_(plane.normal.cross(x_)) {}

  void count(const Eigen::Vector3f& p) { vote(p, counts_); }
  bool belongs(const Eigen::Vector3f& p) const {
    const cv::Point c = cell_of(p);
    return inside(c) && object_(c);
  }

  // Everything connected with the cells of the seeds, over gaps of a cell.
  void grow(const std::vector<Eigen::Vector3f>& seeds, int least) {
    cv::Mat_<int> votes = cv::Mat_<int>::zeros(kSide, kSide);
    for (const Eigen::Vector3f& p : seeds) vote(p, votes);
    double most = 0;
    cv::minMaxLoc(votes, nullptr, &most);
    const cv::Mat_<std::uint8_t> covered = counts_ >= least;
    cv::Mat_<std::uint8_t> grown = (4 * votes >= most) & covered;
    while (cv::countNonZero(grown != object_) > 0) {
      object_ = grown.clone();
      cv::dilate(object_, grown, cv::Mat::ones(5, 5, CV_8U));
      grown &= covered;
    }
  }

 private:
  static constexpr int kSide = 160;
  static constexpr float kCell = 0.01f;

  cv::Point cell_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f d = p - origin_;
    return {static_cast<int>(std::floor(d.dot(x_) / kCell)) + kSide / 2,
            static_cast<int>(std::floor(d.dot(y_) / kCell)) + kSide / 2};
  }
  static bool inside(const cv::Point& c) { return cv::Rect(0, 0, kSide, kSide).contains(c); }
  void vote(const Eigen::Vector3f& p, cv::Mat_<int>& votes) const {
    if (const cv::Point c = cell_of(p); inside(c)) ++votes(c);
  }

  Eigen::Vector3f origin_, x_, y_;
  cv::Mat_<int> counts_ = cv::Mat_<int>::zeros(kSide, kSide);
  cv::Mat_<std::uint8_t> object_ = cv::Mat_<std::uint8_t>::zeros(kSide, kSide);
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
    const float h = map.depth[i] > 0 ? table->height(map.points[i]) : 0;
    return h > std::max(0.004f, 2.7f * depth_noise(map.depth[i])) &&
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

}  // namespace bpa::modeling
