// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The noise that a model has learned, against views it was not learned from and the simulator's
// law.
#include "tools/bench_model_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/base/failure.hpp"
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

  double predicted(const NoiseBin& bin) const { return fitted(bin.edge_distance, bin.angle); }
};

std::vector<NoiseBin> well_filled(std::vector<NoiseBin> bins) {
  std::erase_if(bins, [](const NoiseBin& bin) { return bin.count < kMinCount; });
  return bins;
}

/// The factor by which predictions are off: root mean square of its logarithm over all errors.
double factor_off(const Kind& kind) {
  double squares = 0, count = 0;
  for (const NoiseBin& bin : kind.held_out) {
    squares += bin.count * std::pow(std::log(kind.predicted(bin) / bin.sigma), 2);
    count += bin.count;
  }
  return std::exp(std::sqrt(squares / std::max(1.0, count)));
}

using Value = std::function<double(const NoiseBin&)>;

std::vector<NoiseBin> sorted(std::vector<NoiseBin> bins, const Value& by) {
  std::ranges::stable_sort(bins, {}, by);
  return bins;
}

/// Observed over predicted errors: bins by rising prediction, in about ten groups of equally many
/// errors.
draw::Series observed_over_predicted(const Kind& kind) {
  const auto predicted = [&kind](const NoiseBin& bin) { return kind.predicted(bin); };
  const std::vector<NoiseBin> bins = sorted(kind.held_out, predicted);
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

/// y over x of the bins that are `kept`, by rising x.
draw::Series series_of(const Kind& kind, const std::string& name, bool (*kept)(const NoiseBin&),
                       const Value& x, const Value& y) {
  draw::Series series{name, {}, {}};
  for (const NoiseBin& bin : sorted(kind.held_out, x)) {
    if (!kept(bin)) continue;
    series.x.push_back(x(bin));
    series.y.push_back(kind.unit * y(bin));
  }
  return series;
}

bool far_from_edges(const NoiseBin& bin) {
  return bin.edge_distance >= 0.015 && bin.edge_distance <= 0.025;
}
bool somewhat_slanted(const NoiseBin& bin) {
  return bin.angle >= 30 / kDegrees && bin.angle < 37.5 / kDegrees;
}
double degrees(const NoiseBin& bin) { return kDegrees * bin.angle; }
double millimetres(const NoiseBin& bin) { return kMillimetres * bin.edge_distance; }

void save_plots(const Kind& kind, const draw::Series& law, const std::string& start,
                const std::string& model) {
  const Value observed = [](const NoiseBin& bin) { return bin.sigma; };
  const Value fitted = [&kind](const NoiseBin& bin) { return kind.predicted(bin); };
  const auto curves = [&](bool (*kept)(const NoiseBin&), const Value& x) {
    return std::vector<draw::Series>{series_of(kind, "held-out views", kept, x, observed),
                                     series_of(kind, "fitted sigmoids", kept, x, fitted)};
  };
  const std::string title = model + ": " + kind.name, unit = kind.unit_name;
  std::vector<draw::Series> over_angle = curves(far_from_edges, degrees);
  if (!law.x.empty()) over_angle.push_back(law);
  const auto save = [&start](const char* name, const draw::PlotAxes& axes,
                             const std::vector<draw::Series>& series) {
    or_throw(io::write_color_png(start + name + ".png", draw::line_plot(axes, series)));
  };
  save("angle", {title + ", 15 to 25 mm from edges", "surface angle, degrees", unit, 0, 90, 0, 0},
       over_angle);
  save("edge_distance",
       {title + ", surface angle 30 to 37 degrees", "edge distance, mm", unit, 0, 25, 0, 0},
       curves(somewhat_slanted, millimetres));
  save("predicted",
       {title + " of held-out views", "predicted, " + unit, "observed, " + unit, 0, 0, 0, 0, true},
       {observed_over_predicted(kind)});
}

}  // namespace

void measure_noise(const ModelSource& model, const std::vector<PosedView>& views,
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
  const draw::Series law = series_of(
      range, "simulator's law", far_from_edges, degrees,
      [&seen](const NoiseBin& bin) { return sim::published_axial_noise(seen.depth, bin.angle); });
  std::printf(
      "  range noise 15 to 25 mm from edges, mm: angle, fitted, held-out views, simulator's law\n");
  for (const NoiseBin& bin : range.held_out) {
    if (!far_from_edges(bin)) continue;
    std::printf("    %4.0f degrees  %.2f  %.2f  %.2f\n", degrees(bin),
                kMillimetres * range.predicted(bin), kMillimetres * bin.sigma,
                kMillimetres * sim::published_axial_noise(seen.depth, bin.angle));
  }
  std::printf(
      "  predicted noise of held-out views is off by a factor of %.2f (range), %.2f (normals)\n",
      factor_off(range), factor_off(normals));
  if (plots.empty()) return;
  save_plots(range, law, plots + "/" + name + "_range_", name);
  save_plots(normals, {}, plots + "/" + name + "_normals_", name);
}

}  // namespace bpa::cli
