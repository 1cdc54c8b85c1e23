// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/score/score_layer.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace bpa::score {
namespace {

constexpr std::size_t kNumComponents = kScoreComponents.size();
constexpr std::size_t kKnots = ScoreLayer::kKnots;
using Places = std::array<double, kKnots>;

// Evenly spread over the values of right and wrong samples, of which each kind counts for a half.
// A value that many samples share gets one knot; those that this spares halve the widest gaps.
Places choose_places(std::vector<std::pair<double, bool>> values) {
  std::erase_if(values, [](const auto& value) { return std::isnan(value.first); });
  if (values.empty()) values.push_back({0, false});
  std::sort(values.begin(), values.end());
  double count[2] = {1e-9, 1e-9};
  for (const auto& value : values) ++count[value.second];
  std::vector<double> chosen;
  double passed = 0;
  std::size_t next = 0;
  for (const auto& [value, right] : values) {
    passed += 0.5 / count[right];
    while (next < kKnots && passed >= 0.005 + 0.99 * static_cast<double>(next) / (kKnots - 1)) {
      ++next;
      chosen.push_back(value);
    }
  }
  chosen.push_back(values.back().first);
  const double least = 1e-6 * std::max(1e-6, values.back().first - values.front().first);
  const auto same = [least](double a, double b) { return b - a < least; };
  chosen.erase(std::unique(chosen.begin(), chosen.end(), same), chosen.end());
  if (chosen.size() == 1) chosen.push_back(chosen.front() + least);
  while (chosen.size() < kKnots) {
    std::size_t widest = 1;
    for (std::size_t k = 1; k < chosen.size(); ++k) {
      if (chosen[k] - chosen[k - 1] > chosen[widest] - chosen[widest - 1]) widest = k;
    }
    const auto after = chosen.begin() + static_cast<std::ptrdiff_t>(widest);
    chosen.insert(after, (chosen[widest - 1] + chosen[widest]) / 2);
  }
  Places places;
  std::copy_n(chosen.begin(), kKnots - 1, places.begin());
  places.back() = chosen.back();
  return places;
}

// Between which knots a value lies, and how far along.
std::pair<std::size_t, double> position(const Places& places, double x) {
  if (!(x > places.front())) return {0, 0.0};
  if (x >= places.back()) return {kKnots - 2, 1.0};
  std::size_t k = 0;
  while (x >= places[k + 1]) ++k;
  return {k, (x - places[k]) / (places[k + 1] - places[k])};
}

constexpr Eigen::Index kNumWeights =
    static_cast<Eigen::Index>(kKnots) * static_cast<Eigen::Index>(kNumComponents) + 1;
using Weights = Eigen::Matrix<double, kNumWeights, 1>;

Eigen::Index weight_of(std::size_t feature, std::size_t knot) {
  return static_cast<Eigen::Index>(1 + feature * kKnots + knot);
}

// The gradient of a frame's negative log likelihood by the scores of its samples.
std::vector<double> gradient_by_score(const ScoreFrame& frame, std::span<const double> scores) {
  std::vector<double> odds, by_score(scores.size(), 0);
  for (const double score : scores) odds.push_back(std::exp(std::min(30.0, score)));
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const auto& rivals = frame.competition.rivals[i];
    double right = odds[i], all = 1 + odds[i];
    for (const auto& rival : rivals) {
      all += odds[rival.other];
      right += rival.same_pose * odds[rival.other];
    }
    const double p = std::min(right / all, 1 - 1e-9);
    // d(-log likelihood) / d(score j) = (p - label) / (1 - p) * (part of j in `right` / p - part
    // of j in `all`), all over p or 1 - p.
    const double outer = frame.samples[i].right ? -1 / p : 1 / (1 - p);
    const auto add = [&](std::size_t j, double same) {
      by_score[j] += outer * odds[j] * (same - p) / all;
    };
    add(i, 1);
    for (const auto& rival : rivals) add(rival.other, rival.same_pose);
  }
  return by_score;
}

// The samples of one frame, by where their values lie between knots.
class FrameLikelihood {
 public:
  FrameLikelihood(const ScoreFrame& frame, std::span<const Places> places) : frame_(frame) {
    for (const ScoreFrame::Sample& sample : frame.samples) {
      Row& row = rows_.emplace_back();
      for (std::size_t f = 0; f < kNumComponents; ++f) {
        if (!kScoreComponents[f].learned || std::isnan(sample.values[f])) continue;
        row.entries[f] = position(places[f], sample.values[f]);
        row.known[f] = true;
      }
    }
  }

  // Adds the gradient of the negative log likelihood of the labels.
  void add_gradient(const Weights& weights, Weights& gradient) const {
    std::vector<double> scores;
    for (const Row& row : rows_) scores.push_back(score_of(row, weights));
    const std::vector<double> by_score = gradient_by_score(frame_, scores);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      gradient[0] += by_score[i];
      for (std::size_t f = 0; f < kNumComponents; ++f) {
        if (!rows_[i].known[f]) continue;
        const auto [knot, along] = rows_[i].entries[f];
        gradient[weight_of(f, knot)] += (1 - along) * by_score[i];
        gradient[weight_of(f, knot + 1)] += along * by_score[i];
      }
    }
  }

 private:
  struct Row {
    std::array<std::pair<std::size_t, double>, kNumComponents> entries{};
    std::array<bool, kNumComponents> known{};
  };

  static double score_of(const Row& row, const Weights& weights) {
    double sum = weights[0];
    for (std::size_t f = 0; f < kNumComponents; ++f) {
      if (!row.known[f]) continue;
      const auto [knot, along] = row.entries[f];
      sum += (1 - along) * weights[weight_of(f, knot)] + along * weights[weight_of(f, knot + 1)];
    }
    return sum;
  }

  const ScoreFrame& frame_;
  std::vector<Row> rows_;
};

// Small changes, and as smooth as the samples allow. `weights` are relative to the start.
void add_penalty(const Weights& weights, Weights& gradient) {
  // The best of five pairs on simulated frames of another kind than those learned from.
  constexpr double kSize = 1, kRoughness = 10;
  gradient.tail(kNumWeights - 1) += kSize * weights.tail(kNumWeights - 1);
  for (std::size_t f = 0; f < kNumComponents; ++f) {
    for (std::size_t k = 1; k + 1 < kKnots; ++k) {
      const Eigen::Index i = weight_of(f, k);
      const double bend = kRoughness * (weights[i - 1] - 2 * weights[i] + weights[i + 1]);
      gradient[i - 1] += bend;
      gradient[i] -= 2 * bend;
      gradient[i + 1] += bend;
    }
  }
}

// The nearest values that never fall: pools adjacent violators (Barlow et al., "Statistical
// Inference under Order Restrictions", 1972).
void make_rising(std::span<double> values) {
  struct Pool {
    double sum;
    std::size_t count;
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::array<Pool, kKnots> pools;
  std::size_t n = 0;
  for (const double value : values) {
    pools[n++] = {value, 1};
    while (n > 1 && pools[n - 2].mean() > pools[n - 1].mean()) {
      pools[n - 2].sum += pools[n - 1].sum;
      pools[n - 2].count += pools[n - 1].count;
      --n;
    }
  }
  auto value = values.begin();
  for (std::size_t i = 0; i < n; ++i) value = std::fill_n(value, pools[i].count, pools[i].mean());
}

// See ComponentType::rises.
void keep_rising(Weights& weights) {
  for (std::size_t f = 0; f < kNumComponents; ++f) {
    if (kScoreComponents[f].rises) make_rising({&weights[weight_of(f, 0)], kKnots});
  }
}

// Adam (Kingma and Ba, 2015) with falling steps; project(weights) after each.
template <class Vector>
Vector minimise(Vector weights, const auto& gradient_at, const auto& project) {
  constexpr int kIterations = 600;
  Vector mean = Vector::Zero(), square = Vector::Zero();
  for (int k = 1; k <= kIterations; ++k) {
    const Vector gradient = gradient_at(weights);
    mean = 0.9 * mean + 0.1 * gradient;
    square = 0.99 * square + 0.01 * gradient.cwiseAbs2();
    const Vector step = (mean / (1 - std::pow(0.9, k))).array() /
                        ((square / (1 - std::pow(0.99, k))).array().sqrt() + 1e-12);
    weights -= 0.1 * (1 - static_cast<double>(k - 1) / kIterations) * step;
    project(weights);
  }
  return weights;
}

// The number of samples; an error where there are too few of a kind.
Result<std::size_t> count_samples(std::span<const ScoreFrame> frames) {
  std::size_t right = 0, total = 0;
  for (const ScoreFrame& frame : frames) {
    total += frame.samples.size();
    right += std::ranges::count(frame.samples, true, &ScoreFrame::Sample::right);
  }
  if (right >= 10 && right + 10 <= total) return total;
  return invalid_argument("training has " + std::to_string(right) + " right placements of " +
                          std::to_string(total) + "; it needs at least 10 right and 10 wrong ones");
}

std::vector<double> scores_of(const ScoreLayer& layer, const ScoreFrame& frame) {
  std::vector<double> scores;
  for (const auto& sample : frame.samples) scores.push_back(layer.log_odds(sample.values));
  return scores;
}

}  // namespace

double ScoreLayer::Component::at(double x) const {
  if (std::isnan(x)) return 0;
  const auto [knot, along] = position(place, x);
  return (1 - along) * value[knot] + along * value[knot + 1];
}

double ScoreLayer::log_odds(const ScoreValues& values) const {
  double sum = bias;
  for (std::size_t i = 0; i < kNumComponents; ++i) sum += components[i].at(values[i]);
  return sum;
}

std::optional<ScoreValues> measure_while_probable(Evidence& evidence, const ScoreLayer& layer,
                                                  double prior, const Limits& limits) {
  ScoreValues values;
  double log_odds = layer.bias + prior;
  for (std::size_t i = 0; i < kNumComponents; ++i) {
    const ComponentType& type = kScoreComponents[i];
    values[i] = type.round <= Round::three ? type.measure(evidence) : kNotKnown;
    log_odds += layer.components[i].at(values[i]);
    if (log_odds < limits.components[i]) return std::nullopt;
  }
  return values;
}

namespace {

// New places for the component's curve, which is zero.
void begin_curve(std::size_t f, std::span<const ScoreFrame> frames, ScoreLayer& layer) {
  std::vector<std::pair<double, bool>> values;
  for (const ScoreFrame& frame : frames) {
    for (const auto& sample : frame.samples) values.push_back({sample.values[f], sample.right});
  }
  layer.components[f] = {.place = choose_places(std::move(values))};
}

// Fits the bias and the curves of `learned` components; the others stay.
Result<ScoreLayer> fit(const ScoreLayer& start, std::span<const ScoreFrame> frames,
                       const std::array<bool, kNumComponents>& learned) {
  const Result<std::size_t> samples = count_samples(frames);
  if (!samples.ok()) return samples.status();
  std::array<Places, kNumComponents> places;
  Weights weights = Weights::Zero();
  weights[0] = start.bias;
  for (std::size_t f = 0; f < kNumComponents; ++f) {
    places[f] = start.components[f].place;
    for (std::size_t k = 0; k < kKnots; ++k) {
      weights[weight_of(f, k)] = start.components[f].value[k];
    }
  }
  std::vector<FrameLikelihood> likelihoods;
  for (const ScoreFrame& frame : frames) likelihoods.emplace_back(frame, places);
  const auto gradient_at = [&, first = weights](const Weights& at) -> Weights {
    Weights gradient = Weights::Zero();
    add_penalty(at - first, gradient);
    for (const FrameLikelihood& frame : likelihoods) frame.add_gradient(at, gradient);
    for (std::size_t f = 0; f < kNumComponents; ++f) {
      if (!learned[f]) gradient.segment<kKnots>(weight_of(f, 0)).setZero();
    }
    return gradient / static_cast<double>(*samples);
  };
  weights = minimise(weights, gradient_at, keep_rising);
  ScoreLayer layer = start;
  layer.bias = weights[0];
  for (std::size_t f = 0; f < kNumComponents; ++f) {
    if (!learned[f]) continue;
    auto& value = layer.components[f].value;
    for (std::size_t k = 0; k < kKnots; ++k) value[k] = weights[weight_of(f, k)];
    // A component that is not known says as much as the middle of right and wrong ones.
    const double middle = std::accumulate(value.begin(), value.end(), 0.0) / kKnots;
    for (double& v : value) v -= middle;
    layer.bias += middle;
  }
  return layer;
}

}  // namespace

Result<ScoreLayer> train_score_layer(std::span<const ScoreFrame> frames) {
  ScoreLayer start;
  for (std::size_t f = 0; f < kNumComponents; ++f) begin_curve(f, frames, start);
  start.bias = -3;  // most placements are wrong
  return adapt_score_layer(start, frames);
}

Result<ScoreLayer> adapt_score_layer(const ScoreLayer& start, std::span<const ScoreFrame> frames) {
  std::array<bool, kNumComponents> all{};
  all.fill(true);
  return fit(start, frames, all);
}

Result<ScoreLayer> extend_score_layer(const ScoreLayer& start,
                                      const std::function<bool(const ComponentType&)>& is_new,
                                      std::span<const ScoreFrame> frames) {
  ScoreLayer extended = start;
  std::array<bool, kNumComponents> learned{};
  for (std::size_t f = 0; f < kNumComponents; ++f) {
    learned[f] = is_new(kScoreComponents[f]);
    if (learned[f]) begin_curve(f, frames, extended);
  }
  Result<ScoreLayer> layer = fit(extended, frames, learned);
  // What these frames have more or less right placements of than those of `start` is not kept.
  if (layer.ok()) layer->bias = start.bias;
  return layer;
}

Result<ScoreLayer> calibrate_score_layer(const ScoreLayer& layer,
                                         std::span<const ScoreFrame> frames) {
  const Result<std::size_t> samples = count_samples(frames);
  if (!samples.ok()) return samples.status();
  std::vector<std::vector<double>> scores;
  for (const ScoreFrame& frame : frames) scores.push_back(scores_of(layer, frame));
  const auto gradient_at = [&](const Eigen::Vector2d& scale_and_shift) -> Eigen::Vector2d {
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      std::vector<double> changed;
      for (const double score : scores[i]) {
        changed.push_back(scale_and_shift[0] * score + scale_and_shift[1]);
      }
      const std::vector<double> by_score = gradient_by_score(frames[i], changed);
      for (std::size_t k = 0; k < by_score.size(); ++k) {
        gradient += by_score[k] * Eigen::Vector2d(scores[i][k], 1);
      }
    }
    return gradient / static_cast<double>(*samples);
  };
  const Eigen::Vector2d found = minimise(Eigen::Vector2d(1, 0), gradient_at, [](const auto&) {});
  ScoreLayer out = layer;
  for (ScoreLayer::Component& component : out.components) {
    for (double& value : component.value) value *= found[0];
  }
  out.bias = found[0] * layer.bias + found[1];
  return out;
}

Reliability reliability(const ScoreLayer& layer, std::span<const ScoreFrame> frames) {
  Reliability out;
  for (const ScoreFrame& frame : frames) {
    const std::vector<double> scores = scores_of(layer, frame);
    const std::vector<double> probabilities = competing_probabilities(scores, frame.competition);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const double p = probabilities[i];
      Reliability::Bin& bin = out.bins[std::min<std::size_t>(9, static_cast<std::size_t>(10 * p))];
      const bool right = frame.samples[i].right;
      ++bin.count;
      bin.predicted += p;
      bin.right += right;
      ++out.samples;
      out.right += right;
      out.brier_score += (p - right) * (p - right);
      out.log_loss -= std::log(std::max(1e-9, right ? p : 1 - p));
    }
  }
  const double total = std::max(1, out.samples);
  out.brier_score /= total;
  out.log_loss /= total;
  for (Reliability::Bin& bin : out.bins) {
    if (bin.count == 0) continue;
    out.expected_calibration_error += std::abs(bin.predicted - bin.right) / total;
    bin.predicted /= bin.count;
    bin.right /= bin.count;
  }
  return out;
}

}  // namespace bpa::score
