// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The noise that a model has learned, against views it was not learned from and the simulator's
// law.
#include "tools/bench_model_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/draw/plot.hpp"
#include "core/io/image_file.hpp"
#include "core/sim/kinect.hpp"

namespace bpa::cli {
namespace {

constexpr double kMinCount = 50;  // errors of a bin that counts
constexpr double kDegrees = 180 / M_PI, kMillimetres = 1000;

/// One kind of error: of range or of normals.
struct Kind {
  const char* name;
  const char* unit_name;
  double unit;
  const NoiseCurve& fitted;
  std::vector<NoiseBin> held_out;  // those that count
};

std::vector<NoiseBin> well_filled(const std::vector<NoiseBin>& bins) {
  std::vector<NoiseBin> out;
  std::copy_if(bins.begin(), bins.end(), std::back_inserter(out),
               [](const NoiseBin& bin) { return bin.count >= kMinCount; });
  return out;
}

/// The factor by which predictions are off: root mean square of its logarithm over all errors.
double factor_off(const Kind& kind) {
  double squares = 0, count = 0;
  for (const NoiseBin& bin : kind.held_out) {
    const double ratio = kind.fitted(bin.edge_distance, bin.angle) / bin.sigma;
    squares += bin.count * std::pow(std::log(ratio), 2);
    count += bin.count;
  }
  return std::exp(std::sqrt(squares / std::max(1.0, count)));
}

/// Observed errors of what was predicted alike: bins by rising prediction, in about ten groups of
/// as many errors.
draw::Series observed_over_predicted(const Kind& kind) {
  std::vector<NoiseBin> bins = kind.held_out;
  const auto predicted = [&kind](const NoiseBin& bin) {
    return kind.fitted(bin.edge_distance, bin.angle);
  };
  std::sort(bins.begin(), bins.end(),
            [&](const NoiseBin& a, const NoiseBin& b) { return predicted(a) < predicted(b); });
  double all = 0;
  for (const NoiseBin& bin : bins) all += bin.count;
  draw::Series series{"held-out views", {}, {}};
  double count = 0, expected = 0, squares = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    count += bins[i].count;
    expected += bins[i].count * std::pow(predicted(bins[i]), 2);
    squares += bins[i].count * std::pow(bins[i].sigma, 2);
    if (count < 0.1 * all && i + 1 < bins.size()) continue;
    series.x.push_back(kind.unit * std::sqrt(expected / count));
    series.y.push_back(kind.unit * std::sqrt(squares / count));
    count = expected = squares = 0;
  }
  return series;
}

/// Of the bins between two edge distances (metres): what `value` is of each, over its angle.
template <class Value>
draw::Series over_angle(const Kind& kind, const std::string& name, double nearest, double farthest,
                        const Value& value) {
  draw::Series series{name, {}, {}};
  for (const NoiseBin& bin : kind.held_out) {
    if (bin.edge_distance < nearest || bin.edge_distance > farthest) continue;
    series.x.push_back(kDegrees * bin.angle);
    series.y.push_back(kind.unit * value(bin));
  }
  return series;
}

/// The same over edge distance, between two angles (radians).
template <class Value>
draw::Series over_edge_distance(const Kind& kind, const std::string& name, double least,
                                double most, const Value& value) {
  draw::Series series{name, {}, {}};
  std::vector<NoiseBin> bins;
  for (const NoiseBin& bin : kind.held_out) {
    if (bin.angle >= least && bin.angle < most) bins.push_back(bin);
  }
  std::sort(bins.begin(), bins.end(),
            [](const NoiseBin& a, const NoiseBin& b) { return a.edge_distance < b.edge_distance; });
  for (const NoiseBin& bin : bins) {
    series.x.push_back(kMillimetres * bin.edge_distance);
    series.y.push_back(kind.unit * value(bin));
  }
  return series;
}

double highest(const std::vector<draw::Series>& series) {
  double top = 0;
  for (const draw::Series& s : series) {
    for (const double y : s.y) top = std::max(top, y);
  }
  return std::max(1e-9, 1.1 * top);
}

Status save(const std::string& path, draw::PlotAxes axes, const std::vector<draw::Series>& series) {
  axes.y_max = highest(series);
  if (axes.diagonal) {
    for (const double x : series.front().x) axes.y_max = std::max(axes.y_max, 1.1 * x);
    axes.x_max = axes.y_max;
  }
  return io::write_color_png(path, draw::line_plot(axes, series));
}

Status save_plots(const Kind& kind, const draw::Series& law, const std::string& start,
                  const std::string& model) {
  const auto observed = [](const NoiseBin& bin) { return bin.sigma; };
  const auto fitted = [&kind](const NoiseBin& bin) {
    return kind.fitted(bin.edge_distance, bin.angle);
  };
  const std::string title = model + ": " + kind.name;
  std::vector<draw::Series> curves = {over_angle(kind, "held-out views", 0.015, 0.025, observed),
                                      over_angle(kind, "fitted sigmoids", 0.015, 0.025, fitted)};
  if (!law.x.empty()) curves.push_back(law);
  Status status = save(
      start + "angle.png",
      {title + ", 15 to 25 mm from edges", "surface angle, degrees", kind.unit_name, 0, 90, 0, 1},
      curves);
  if (!status.ok()) return status;
  const double least = 30 / kDegrees, most = 37.5 / kDegrees;
  status = save(start + "edge_distance.png",
                {title + ", surface angle 30 to 37 degrees", "edge distance, mm", kind.unit_name, 0,
                 25, 0, 1},
                {over_edge_distance(kind, "held-out views", least, most, observed),
                 over_edge_distance(kind, "fitted sigmoids", least, most, fitted)});
  if (!status.ok()) return status;
  return save(start + "predicted.png",
              {title + " of held-out views", std::string("predicted, ") + kind.unit_name,
               std::string("observed, ") + kind.unit_name, 0, 1, 0, 1, true},
              {observed_over_predicted(kind)});
}

}  // namespace

Status measure_noise(const ModelSource& model, const std::vector<PosedView>& views,
                     const std::string& name, const std::string& plots, int num_threads) {
  std::vector<PosedView> half[2];
  for (std::size_t i = 0; i < views.size(); ++i) half[i % 2].push_back(views[i]);
  ModelSource learned = model;
  learned.normal_variance.clear();
  learn_noise(learned, half[0], num_threads);
  const SurfaceObservations seen = observe_surface(model.surface, half[1], num_threads);
  const Kind range{"range noise", "mm", kMillimetres, learned.noise.range,
                   well_filled(seen.range_bins)};
  const Kind normals{"noise of normals", "degrees", kDegrees, learned.noise.normal,
                     well_filled(seen.normal_bins)};
  const auto published = [&seen](const NoiseBin& bin) {
    return sim::published_axial_noise(seen.depth, bin.angle);
  };
  const draw::Series law = over_angle(range, "simulator's law", 0.015, 0.025, published);
  std::printf(
      "  range noise 15 to 25 mm from edges, mm: angle, fitted, held-out views, simulator's law\n");
  std::size_t row = 0;
  for (const NoiseBin& bin : range.held_out) {
    if (bin.edge_distance < 0.015 || bin.edge_distance > 0.025) continue;
    std::printf("    %4.0f degrees  %.2f  %.2f  %.2f\n", law.x[row],
                kMillimetres * range.fitted(bin.edge_distance, bin.angle), kMillimetres * bin.sigma,
                law.y[row]);
    ++row;
  }
  std::printf(
      "  predicted noise of held-out views is off by a factor of %.2f (range), %.2f (normals)\n",
      factor_off(range), factor_off(normals));
  if (plots.empty()) return {};
  if (Status s = save_plots(range, law, plots + "/" + name + "_range_", name); !s.ok()) return s;
  return save_plots(normals, {}, plots + "/" + name + "_normals_", name);
}

}  // namespace bpa::cli
