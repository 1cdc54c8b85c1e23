// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/pair_voting.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/dispatch.hpp"
#include "core/base/parallel.hpp"
#include "core/cloud/neighbor_grid.hpp"

namespace bpa::features {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kAngleStep = kPi / kPairAngleBins;
constexpr float kFixingAngle = 0.35f;  // radians, 20 degrees; chosen by hand
constexpr float kOuterPart = 0.15f;    // of a bin, from which the next bin is searched too

float safe_acos(float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); }

// The bins a value is found in: its own, and the next one where it lies near the border.
struct Bins {
  int first = 0, last = 0;
};

Bins bins_of(float scaled, int count) {
  const int own = std::min(static_cast<int>(scaled), count - 1);
  const float inside = scaled - static_cast<float>(own);
  return {inside < kOuterPart ? std::max(0, own - 1) : own,
          inside > 1 - kOuterPart ? std::min(count - 1, own + 1) : own};
}

// Calls visit(key) for every cell that the feature is found in.
void for_each_key(const PointPairFeature& f, float inverse_step, const auto& visit) {
  const Bins d = bins_of(f.distance * inverse_step, 1 << 20);
  const Bins a = bins_of(f.angle_first / kAngleStep, kPairAngleBins);
  const Bins b = bins_of(f.angle_second / kAngleStep, kPairAngleBins);
  const Bins c = bins_of(f.angle_normals / kAngleStep, kPairAngleBins);
  for (int i = d.first; i <= d.last; ++i) {
    for (int j = a.first; j <= a.last; ++j) {
      for (int k = b.first; k <= b.last; ++k) {
        for (int l = c.first; l <= c.last; ++l) {
          visit(static_cast<std::uint32_t>(
              ((i * kPairAngleBins + j) * kPairAngleBins + k) * kPairAngleBins + l));
        }
      }
    }
  }
}

// The first key beyond those that pairs of kMaxPairLength are looked up under. A pair measured in
// another frame may be longer by rounding.
std::uint32_t end_of_keys(float inverse_step) {
  constexpr float kRounding = 1.001f;
  constexpr auto kLongest = kRounding * static_cast<float>(kMaxPairLength);
  const auto last_bin = static_cast<std::uint32_t>(kLongest * inverse_step);
  return (last_bin + 1) * PointPairTable::kAngleKeys;
}

constexpr std::size_t kMaxPoints = 65535;  // of a table: an entry's index has 16 bits
constexpr int kTurnBins = 32;
constexpr int kStepsPerBin = kTurnSteps / kTurnBins;
using Count = std::int16_t;     // signed: x86-64 without SSE4.1 has no largest of unsigned ones
constexpr Count kMinVotes = 3;  // of a voted pose; chosen by hand
// Of the pairs whose cell has this many entries, one in two votes; of four times as many, one in
// four. They tell little: 9 % of the lookups, in piles of seed 777, have 52 % of the entries.
// Chosen by hand: by three seeds of the search, 811/1137 objects of YCB-Video and of seeds 100 and
// 777 are found with 256, 823 with 512, and 822 where all vote. All measured at 726d162, with
// models of up to 500 points; those of 200 have fewer entries in a cell.
constexpr std::size_t kFrequent = 512;

// Raises each to the sum of both, where that is larger.
BPA_DISPATCH void raise_to_sums(const Count* first, const Count* second, std::size_t size,
                                Count* __restrict most) {
  for (std::size_t i = 0; i < size; ++i) {
    const auto both = static_cast<Count>(first[i] + second[i]);
    most[i] = both > most[i] ? both : most[i];
  }
}

// The votes about one reference point. Those of one bin lie side by side.
class Votes {
 public:
  explicit Votes(std::size_t num_points)
      : num_points_(num_points), votes_(num_points * kTurnBins), most_(num_points) {}

  void clear() { std::fill(votes_.begin(), votes_.end(), Count{0}); }
  void add(std::size_t point, std::uint8_t turn, std::uint32_t vote) {
    votes_[turn / kStepsPerBin * num_points_ + point] += static_cast<Count>(vote);
  }
  // For each model point, the most votes in a bin and the one after it.
  std::span<const Count> most() {
    std::fill(most_.begin(), most_.end(), Count{0});
    for (int b = 0; b < kTurnBins; ++b) {
      raise_to_sums(bin(b).data(), bin((b + 1) % kTurnBins).data(), num_points_, most_.data());
    }
    return most_;
  }
  // The middle of these two bins' votes, in radians.
  float turn_of_most(std::size_t point) const {
    int b = 0;
    while (b + 1 < kTurnBins && bin(b)[point] + bin(b + 1)[point] != most_[point]) ++b;
    const float here = bin(b)[point], after = bin((b + 1) % kTurnBins)[point];
    const float middle = static_cast<float>(b) + after / std::max(1.0f, here + after);
    return (middle * kStepsPerBin + 0.5f * (kStepsPerBin - 1)) * (2 * kPi / kTurnSteps);
  }

 private:
  std::span<const Count> bin(int b) const {
    return std::span(votes_).subspan(static_cast<std::size_t>(b) * num_points_, num_points_);
  }

  std::size_t num_points_;
  std::vector<Count> votes_, most_;
};

// Sets which model points have an agreeing colour; false where none has.
bool find_agreeing(const MatchColor& reference, std::span<const MatchColor> model,
                   std::vector<std::uint8_t>& agree) {
  std::uint8_t any = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    agree[i] = colors_agree(reference, model[i]);
    any |= agree[i];
  }
  return any != 0;
}

// For the partners of pairs, a bit for each colour of the palette that agrees with theirs.
class AgreeingColors {
 public:
  AgreeingColors(const ScenePairs& pairs, const PairColors& colors) {
    if (colors.palette.empty()) return;
    bits_.resize(colors.scene.size(), kUnknown);
    for (const ScenePairs::Partner& partner : pairs.partners) {
      if (partner.point < 0 || bits_[partner.point] != kUnknown) continue;
      std::uint32_t& bits = bits_[partner.point];
      bits = 0;
      for (std::size_t c = 0; c < colors.palette.size(); ++c) {
        const bool agrees = colors_agree(colors.scene[partner.point], colors.palette[c]);
        bits |= std::uint32_t{agrees} << c;
      }
    }
  }
  // All where no colour is known.
  std::uint32_t of(const ScenePairs::Partner& partner) const {
    return bits_.empty() || partner.point < 0 ? ~0U : bits_[partner.point];
  }

 private:
  static constexpr std::uint32_t kUnknown = 1U << kAnyColor;

  std::vector<std::uint32_t> bits_;  // by the partner's index in the cloud
};

// Whether the `number`-th pair of a reference point votes in a cell of this size.
bool has_vote(std::uint32_t number, std::size_t size) {
  return size < kFrequent || number % (size < 4 * kFrequent ? 2 : 4) == 0;
}

// The model points with the most votes, best first.
class Peaks {
 public:
  explicit Peaks(std::size_t wanted) : wanted_(wanted) {}

  // Of those that agree.
  void find(std::span<const Count> most, std::span<const std::uint8_t> agree) {
    points_.clear();
    if (wanted_ == 0) return;
    Count least = kMinVotes;  // of a further one
    for (std::size_t i = 0; i < most.size(); ++i) {
      if (most[i] < least || !agree[i]) continue;
      if (points_.size() == wanted_) points_.pop_back();
      auto at = points_.end();
      while (at != points_.begin() && most[*(at - 1)] < most[i]) --at;
      points_.insert(at, static_cast<int>(i));
      if (points_.size() == wanted_) least = static_cast<Count>(most[points_.back()] + 1);
    }
  }
  const std::vector<int>& points() const { return points_; }

 private:
  std::size_t wanted_;
  std::vector<int> points_;
};

}  // namespace

PointPairFeature point_pair_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                    const Eigen::Vector3f& q, const Eigen::Vector3f& nq) {
  const Eigen::Vector3f line = q - p;
  const float distance = line.norm();
  const float inverse = distance > 1e-9f ? 1 / distance : 0;
  return {distance, safe_acos(np.dot(line) * inverse), safe_acos(nq.dot(line) * inverse),
          safe_acos(np.dot(nq))};
}

std::optional<PointPairFeature> rim_feature(const Eigen::Vector3f& p, const Eigen::Vector3f& np,
                                            const RimPoint& rim) {
  constexpr float kMinDistance = 0.005f;  // metres; chosen by hand
  PointPairFeature feature = point_pair_feature(p, np, rim.point, rim.normal);
  if (feature.distance < kMinDistance || fixes_pose(feature)) return {};
  feature.angle_first = 0.5f * kAngleStep;  // the middle of a bin
  feature.angle_second = safe_acos(rim.outward.dot(rim.point - p) / feature.distance);
  feature.angle_normals = 0.5f * kAngleStep;
  return feature;
}

bool fixes_pose(const PointPairFeature& f) {
  return f.angle_normals > kFixingAngle || std::abs(f.angle_first - 0.5f * kPi) > kFixingAngle;
}

Eigen::Matrix3f basis_of(const Eigen::Vector3f& normal) {
  const Eigen::Vector3f helper =
      std::abs(normal.x()) < 0.6f ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  Eigen::Matrix3f basis;
  basis.col(0) = (helper - normal * normal.dot(helper)).normalized();
  basis.col(1) = normal.cross(basis.col(0));
  basis.col(2) = normal;
  return basis;
}

std::uint16_t pair_angle_key(const PointPairFeature& f) {
  const auto bin = [](float angle) {
    return std::min(static_cast<int>(angle / kAngleStep), kPairAngleBins - 1);
  };
  return static_cast<std::uint16_t>((bin(f.angle_first) * kPairAngleBins + bin(f.angle_second)) *
                                        kPairAngleBins +
                                    bin(f.angle_normals));
}

std::uint8_t turn_of(const Eigen::Matrix3f& basis, const Eigen::Vector3f& line) {
  const float angle = std::atan2(basis.col(1).dot(line), basis.col(0).dot(line));
  const float steps = angle * (kTurnSteps / (2 * kPi));
  return static_cast<std::uint8_t>(static_cast<int>(std::floor(steps + 0.5f)) & (kTurnSteps - 1));
}

// Calls for_each_pair(visit(index of the first point, second point, feature)) twice: how many pairs
// there are of each key, then where each goes.
void PointPairTable::fill(const PointCloud& points, const auto& for_each_pair) {
  const std::uint32_t end = end_of_keys(inverse_step_);
  std::vector<std::uint32_t> first;
  for_each_pair(
      [&](std::size_t, const Eigen::Vector3f&, std::uint8_t, const PointPairFeature& feature) {
        max_distance_ = std::max(max_distance_, feature.distance);
        for_each_key(feature, inverse_step_, [&](std::uint32_t key) {
          if (key >= end) return;
          if (key + 2 > first.size()) first.resize(key + 2, 0);
          ++first[key + 1];
        });
      });
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  std::vector<Entry> entries(first.empty() ? 0 : first.back());
  std::vector<Eigen::Matrix3f> bases;
  for (const Eigen::Vector3f& normal : points.normals) bases.push_back(basis_of(normal));
  std::vector<std::uint32_t> next = first;
  for_each_pair([&](std::size_t i, const Eigen::Vector3f& second, std::uint8_t color,
                    const PointPairFeature& feature) {
    const Entry entry{static_cast<std::uint16_t>(i), turn_of(bases[i], second - points.points[i]),
                      color};
    for_each_key(feature, inverse_step_, [&](std::uint32_t key) {
      if (key < end) entries[next[key]++] = entry;
    });
  });
  first_ = std::move(first);
  entries_ = std::move(entries);
}

bool PointPairTable::Arrays::fit(std::size_t num_points) const {
  // Of any table: what is beyond is no number of metres, and bins would overflow.
  constexpr float kMostPerMetre = 1e4f, kLongest = 1e3f;
  const bool numbers = inverse_step > 1 / kLongest && inverse_step < kMostPerMetre &&
                       max_distance >= 0 && max_distance < kLongest;
  if (!numbers || entries.size() != (first.empty() ? 0 : first.back())) return false;
  std::uint32_t falling = 0;
  for (std::size_t k = 1; k < first.size(); ++k) falling |= first[k] < first[k - 1];
  std::uint16_t largest = 0;
  std::uint8_t last_color = 0;
  for (const Entry& entry : entries) {
    largest = std::max(largest, entry.point);
    last_color = std::max(last_color, entry.color);
  }
  return falling == 0 && last_color <= kAnyColor && (entries.empty() || largest < num_points);
}

PointPairTable::PointPairTable(const PointCloud& points, float distance_step,
                               std::span<const std::uint8_t> colors)
    : inverse_step_(1 / distance_step) {
  const std::size_t count = std::min(points.size(), kMaxPoints);
  fill(points, [&](const auto& visit) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (i == j) continue;
        const PointPairFeature feature = point_pair_feature(points.points[i], points.normals[i],
                                                            points.points[j], points.normals[j]);
        if (feature.distance >= distance_step && fixes_pose(feature)) {
          visit(i, points.points[j], colors.empty() ? kAnyColor : colors[j], feature);
        }
      }
    }
  });
}

PointPairTable::PointPairTable(const PointCloud& points, std::span<const RimPoint> rims,
                               float distance_step)
    : inverse_step_(1 / distance_step) {
  const std::size_t count = std::min(points.size(), kMaxPoints);
  fill(points, [&](const auto& visit) {
    for (std::size_t i = 0; i < count; ++i) {
      for (const RimPoint& rim : rims) {
        const auto feature = rim_feature(points.points[i], points.normals[i], rim);
        if (feature) visit(i, rim.point, kAnyColor, *feature);
      }
    }
  });
}

namespace {

// add(index of the reference point, its basis, out) adds its partners.
ScenePairs pairs_about(const PointCloud& cloud, std::vector<int> references, int num_threads,
                       const auto& add) {
  ScenePairs out;
  out.references = std::move(references);
  out.first.assign(out.references.size() + 1, 0);
  std::vector<std::vector<ScenePairs::Partner>> partners(out.references.size());
  parallel_for(out.references.size(), num_threads, [&](std::size_t r) {
    const std::size_t i = out.references[r];
    add(i, basis_of(cloud.normals[i]), partners[r]);
    std::ranges::stable_sort(partners[r], {}, &ScenePairs::Partner::distance);
  });
  for (std::size_t r = 0; r < partners.size(); ++r) {
    out.partners.insert(out.partners.end(), partners[r].begin(), partners[r].end());
    out.first[r + 1] = static_cast<std::uint32_t>(out.partners.size());
  }
  return out;
}

}  // namespace

ScenePairs scene_pairs(const PointCloud& cloud, std::vector<int> references, float reach, int step,
                       int num_threads, std::span<const std::uint8_t> partners) {
  const NeighborGrid grid(cloud.points, reach);
  const auto add = [&](std::size_t i, const Eigen::Matrix3f& basis, auto& found) {
    grid.for_each_neighbor(cloud.points[i], [&](std::size_t j, float) {
      if (i == j || (i + j) % static_cast<std::size_t>(step) != 0) return;
      if (!partners.empty() && !partners[j]) return;
      const PointPairFeature feature =
          point_pair_feature(cloud.points[i], cloud.normals[i], cloud.points[j], cloud.normals[j]);
      if (!fixes_pose(feature)) return;
      found.push_back({feature.distance, pair_angle_key(feature),
                       turn_of(basis, cloud.points[j] - cloud.points[i]),
                       static_cast<std::int32_t>(j)});
    });
  };
  return pairs_about(cloud, std::move(references), num_threads, add);
}

ScenePairs scene_rim_pairs(const PointCloud& cloud, std::span<const RimPoint> rims,
                           std::vector<int> references, float reach, int num_threads) {
  std::vector<Eigen::Vector3f> ends;
  for (const RimPoint& rim : rims) ends.push_back(rim.point);
  const NeighborGrid grid(ends, reach);
  const auto add = [&](std::size_t i, const Eigen::Matrix3f& basis, auto& partners) {
    grid.for_each_neighbor(cloud.points[i], [&](std::size_t j, float) {
      const auto feature = rim_feature(cloud.points[i], cloud.normals[i], rims[j]);
      if (!feature) return;
      partners.push_back({feature->distance, pair_angle_key(*feature),
                          turn_of(basis, ends[j] - cloud.points[i]), -1});
    });
  };
  return pairs_about(cloud, std::move(references), num_threads, add);
}

std::vector<VotedPose> vote_poses(const ScenePairs& pairs, const PointPairTable& table,
                                  int num_model_points, int peaks, const PairColors& colors,
                                  const std::function<bool()>& late) {
  std::vector<VotedPose> out;
  Votes votes(static_cast<std::size_t>(num_model_points));
  Peaks best(peaks);
  const bool colored = !colors.scene.empty() && !colors.model.empty();
  std::vector<std::uint8_t> agree(static_cast<std::size_t>(num_model_points), 1);
  const AgreeingColors second(pairs, colored ? colors : PairColors{});
  for (std::size_t r = 0; r < pairs.references.size(); ++r) {
    const bool votes_for_none = pairs.first[r] == pairs.first[r + 1] ||
                                pairs.partners[pairs.first[r]].distance > table.max_distance();
    if (late && late()) break;
    if (votes_for_none) continue;
    if (colored && !find_agreeing(colors.scene[pairs.references[r]], colors.model, agree)) continue;
    votes.clear();
    for (std::uint32_t k = pairs.first[r]; k < pairs.first[r + 1]; ++k) {
      const ScenePairs::Partner& partner = pairs.partners[k];
      if (partner.distance > table.max_distance()) break;
      const std::uint32_t colors_of_entries = second.of(partner);
      if (colors_of_entries == 0) continue;
      const auto cell = table.lookup(partner.distance, partner.angle_key);
      if (!has_vote(k - pairs.first[r], cell.size())) continue;
      for (const auto& entry : cell) {
        votes.add(entry.point, static_cast<std::uint8_t>(partner.turn - entry.turn),
                  colors_of_entries >> entry.color & 1);
      }
    }
    const std::span<const Count> most = votes.most();
    best.find(most, agree);
    for (const int point : best.points()) {
      out.push_back({pairs.references[r], point, votes.turn_of_most(point), most[point]});
    }
  }
  return out;
}

}  // namespace bpa::features
