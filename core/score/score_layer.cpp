// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <tuple>

#include <bpa/core/score/score_layer.hpp>

namespace bpa {
namespace {

constexpr std::array<const char*, kNumScoreFeatures> kNames = {
    "range",      "normal",          "agreeing",        "free_space",     "visibility",
    "edge",       "edge_support",    "edge_visibility", "shape",          "relative_area",
    "unknown",    "explained",       "evidence",        "range_evidence", "edge_evidence",
    "background", "support",         "edge_likelihood", "occlusion_edge", "random_walk",
    "segment",    "segment_affinity"};

// The 0.5 % and 99.5 % values.
std::pair<double, double> usual_range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double part) {
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
  };
  return {at(0.005), at(0.995)};
}

// A feature's place between low and high, as -1..1.
double scaled(const ScoreLayer::Component& c, double x) {
  const double middle = 0.5 * (c.low + c.high);
  return (std::clamp(x, c.low, c.high) - middle) / std::max(1e-9, 0.5 * (c.high - c.low));
}

constexpr Eigen::Index kNumWeights = 2 * static_cast<Eigen::Index>(kNumScoreFeatures) + 1;
using Weights = Eigen::Matrix<double, kNumWeights, 1>;

// The likelihood of the labels of one frame's samples, and its gradient.
class FrameLikelihood {
 public:
  FrameLikelihood(const ScoreFrame& frame, const ScoreLayer& ranges) : frame_(frame) {
    rows_.resize(static_cast<Eigen::Index>(frame.samples.size()), kNumWeights);
    for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
      rows_(i, 0) = 1;
      for (std::size_t f = 0; f < kNumScoreFeatures; ++f) {
        const double x =
            scaled(ranges.components[f], frame.samples[static_cast<std::size_t>(i)].features[f]);
        rows_(i, 1 + 2 * static_cast<Eigen::Index>(f)) = x;
        rows_(i, 2 + 2 * static_cast<Eigen::Index>(f)) = x * x;
      }
    }
  }

  // Adds the gradient of the negative log likelihood.
  void add_gradient(const Weights& weights, Weights& gradient) const {
    const Eigen::VectorXd scores = rows_ * weights;
    const Eigen::VectorXd odds = scores.array().min(30).exp();
    Eigen::VectorXd by_score = Eigen::VectorXd::Zero(scores.size());
    for (Eigen::Index i = 0; i < scores.size(); ++i) {
      const auto& rivals = frame_.competition.rivals[static_cast<std::size_t>(i)];
      double right = odds[i], all = 1 + odds[i];
      for (const auto& rival : rivals) {
        all += odds[rival.other];
        if (rival.same_pose) right += odds[rival.other];
      }
      const double p = std::min(right / all, 1 - 1e-9);
      const bool label = frame_.samples[static_cast<std::size_t>(i)].right;
      // d(-log likelihood) / d(score j) = (p - label) / (1 - p) * (part of j in `right` / p - part
      // of j in `all`), all over p or 1 - p.
      const double outer = label ? -1 / p : 1 / (1 - p);
      const auto add = [&](Eigen::Index j, bool same) {
        by_score[j] += outer * odds[j] * ((same ? 1.0 : 0.0) - p) / all;
      };
      add(i, true);
      for (const auto& rival : rivals) add(rival.other, rival.same_pose);
    }
    gradient.noalias() += rows_.transpose() * by_score;
  }

 private:
  const ScoreFrame& frame_;
  Eigen::MatrixXd rows_;
};

// Adam (Kingma and Ba, 2015) on all frames at once, with falling steps.
Weights minimise(const std::vector<FrameLikelihood>& frames, double samples) {
  constexpr int kIterations = 600;
  constexpr double kPenalty = 1;  // of the squares of the weights
  Weights weights = Weights::Zero(), mean = Weights::Zero(), square = Weights::Zero();
  weights[0] = -3;
  for (int k = 1; k <= kIterations; ++k) {
    Weights gradient = kPenalty * weights;
    gradient[0] = 0;
    for (const FrameLikelihood& frame : frames) frame.add_gradient(weights, gradient);
    gradient /= samples;
    mean = 0.9 * mean + 0.1 * gradient;
    square = 0.99 * square + 0.01 * gradient.cwiseAbs2();
    const Weights step = (mean / (1 - std::pow(0.9, k))).array() /
                         ((square / (1 - std::pow(0.99, k))).array().sqrt() + 1e-12);
    weights -= 0.1 * (1 - static_cast<double>(k - 1) / kIterations) * step;
  }
  return weights;
}

}  // namespace

std::span<const char* const, kNumScoreFeatures> score_feature_names() { return kNames; }

ScoreFeatures score_features(const ScoreComponents& c) {
  // Evidence grows with the explained surface, not with how near the camera is; far away, fewer
  // pixels say less.
  constexpr double kPixelsPerArea = 7e4;  // of a square metre seen from one metre, at 320 x 240
  const double support = std::min(c.explained_pixels, kPixelsPerArea * c.explained_area);
  const double evidence = std::log(std::max(1.0, support));
  return {c.range,
          c.normal,
          c.agreeing,
          c.free_space,
          c.visibility,
          c.edge,
          c.edge_support,
          c.edge_visibility,
          std::sqrt(std::max(0.0, c.shape)),
          c.relative_area,
          c.unknown,
          c.explained_pixels / std::max(1.0, c.expected_pixels),
          evidence,
          c.range * evidence,
          c.edge * evidence,
          c.background,
          std::sqrt(std::max(0.0, support)),
          c.edge_likelihood,
          c.occlusion_edge,
          c.random_walk,
          c.segment,
          c.segment_affinity};
}

double ScoreLayer::log_odds(const ScoreFeatures& features) const {
  double sum = bias;
  for (std::size_t i = 0; i < kNumScoreFeatures; ++i) {
    const double x = scaled(components[i], features[i]);
    sum += x * (components[i].linear + x * components[i].quadratic);
  }
  return sum;
}

Result<ScoreLayer> train_score_layer(std::span<const ScoreFrame> frames) {
  std::array<std::vector<double>, kNumScoreFeatures> values;
  std::size_t right = 0, total = 0;
  for (const ScoreFrame& frame : frames) {
    for (const ScoreFrame::Sample& sample : frame.samples) {
      right += sample.right;
      ++total;
      for (std::size_t f = 0; f < kNumScoreFeatures; ++f) values[f].push_back(sample.features[f]);
    }
  }
  if (right < 10 || right + 10 > total) {
    return invalid_argument("training has " + std::to_string(right) + " right placements of " +
                            std::to_string(total) +
                            "; it needs at least 10 right and 10 wrong ones");
  }
  ScoreLayer layer;
  for (std::size_t f = 0; f < kNumScoreFeatures; ++f) {
    std::tie(layer.components[f].low, layer.components[f].high) = usual_range(values[f]);
  }
  std::vector<FrameLikelihood> likelihoods;
  for (const ScoreFrame& frame : frames) likelihoods.emplace_back(frame, layer);
  const Weights weights = minimise(likelihoods, static_cast<double>(total));
  layer.bias = weights[0];
  for (std::size_t f = 0; f < kNumScoreFeatures; ++f) {
    layer.components[f].linear = weights[1 + 2 * static_cast<Eigen::Index>(f)];
    layer.components[f].quadratic = weights[2 + 2 * static_cast<Eigen::Index>(f)];
  }
  return layer;
}

Reliability reliability(const ScoreLayer& layer, std::span<const ScoreFrame> frames) {
  Reliability out;
  for (const ScoreFrame& frame : frames) {
    std::vector<double> scores;
    for (const auto& sample : frame.samples) scores.push_back(layer.log_odds(sample.features));
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
    }
  }
  const double total = std::max(1, out.samples);
  out.brier_score /= total;
  for (Reliability::Bin& bin : out.bins) {
    if (bin.count == 0) continue;
    out.expected_calibration_error += std::abs(bin.predicted - bin.right) / total;
    bin.predicted /= bin.count;
    bin.right /= bin.count;
  }
  return out;
}

}  // namespace bpa
