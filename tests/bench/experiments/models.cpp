// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa-experiments models: models made from turntable scans against the true meshes, and the noise
// that they have learned against views not learned from and the simulator's law.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include <sys/resource.h>

#include "core/base/stopwatch.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/draw/plot.hpp"
#include "core/geometry/pose.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/model_source.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "core/sim/kinect.hpp"
#include "tests/bench/experiments/experiments.hpp"
#include "tools/posed_views.hpp"

namespace bpa::cli {
namespace {

struct ModelsArguments {
  CommonOptions common;
  std::vector<std::string> scans;
  std::string split = "test";
  std::string plots, library;  // where to write; empty = nowhere
  double step_deg = 10;
};

double quantile(std::vector<float> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(q * (values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

/// How far each point is from the nearest sample's tangent plane, of those that face the same way;
/// infinite beyond 2 cm.
std::vector<float> distances(const PointCloud& points, const PointCloud& surface) {
  constexpr float kReach = 0.02f, kSampling = 0.002f;
  const NeighborGrid near(surface.points, 0.005f), far(surface.points, kReach);
  std::vector<float> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float squared = kReach * kReach, distance = std::numeric_limits<float>::infinity();
    const auto consider = [&](int j, float d) {
      if (d >= squared || surface.normals[j].dot(points.normals[i]) < 0.2f) return;
      squared = d;
      const float off = std::abs(surface.normals[j].dot(points.points[i] - surface.points[j]));
      const float along = std::sqrt(std::max(0.0f, d - off * off));
      distance = along < kSampling ? off : std::sqrt(d);
    };
    near.for_each_neighbor(points.points[i], consider);
    if (distance > 1) far.for_each_neighbor(points.points[i], consider);
    out.push_back(distance);
  }
  return out;
}

PointCloud moved(PointCloud cloud, const Pose& pose) {
  const FastPose fast = to_fast(pose);
  for (auto& p : cloud.points) p = fast * p;
  for (auto& n : cloud.normals) n = fast.rotation * n;
  return cloud;
}

/// The part of the surface (mesh frame) that the images of the scan could show, whether or not the
/// sensor measured it: in sight, not more slanted than 75 degrees.
PointCloud in_sight(const PointCloud& surface, const std::vector<io::BopFrame>& frames) {
  std::vector<std::uint8_t> seen(surface.size(), 0);
  for (const io::BopFrame& frame : frames) {
    if (frame.truth.empty()) continue;
    const Eigen::Vector3f eye =
        frame.truth[0].camera_from_object.inverse().translation.cast<float>();
    for (const std::uint32_t i : render_from(surface, eye, 0.002f).visible) {
      seen[i] |= surface.normals[i].dot((eye - surface.points[i]).normalized()) > 0.26f;
    }
  }
  return select(surface, [&seen](int i) { return seen[i] != 0; });
}

/// How far the found centre of rotation is from the axis about which the truth turns.
double axis_error(const Eigen::Vector3d& centre, const Pose& first, const Pose& later) {
  const Pose motion = later * first.inverse();
  const Eigen::Vector3d axis = vector_from_rotation(motion.rotation).normalized();
  const Eigen::Vector3d off = motion * centre - centre;  // 2 sin(angle / 2) times the distance
  const double angle = vector_from_rotation(motion.rotation).norm();
  return (off - off.dot(axis) * axis).norm() / (2 * std::sin(0.5 * angle));
}

/// What a scan was simulated of.
struct Truth {
  std::string name;
  std::vector<io::BopFrame> frames;
  PointCloud surface;  // of the mesh, a point each millimetre

  const Pose& camera_from_mesh(std::size_t frame) const {
    return frames[frame].truth[0].camera_from_object;
  }
};

Truth read_truth(const std::string& folder, const std::string& split) {
  Truth truth;
  truth.frames = or_throw(io::read_bop_frames(folder, split));
  if (std::ranges::any_of(truth.frames, [](const auto& frame) { return frame.truth.empty(); })) {
    throw Failure({StatusCode::not_found, folder + ": frames without truth"});
  }
  const io::BopModel model = or_throw(io::read_bop_models(folder)).front();
  truth.name = model.name;
  modeling::ModelOptions fine;
  fine.spacing_m = 0.001;
  const TriangleMesh mesh = or_throw(io::read_mesh(model.path, 0.001));
  truth.surface =
      or_throw(modeling::model_source_from_mesh(mesh, "truth", 1, fine), folder).surface;
  return truth;
}

void print_axes(const modeling::AlignedScan& scan, const Truth& truth) {
  std::size_t first = 0;
  for (const modeling::RestingPosition& position : scan.positions) {
    // The truth of this position: its first frame and one a quarter turn later.
    const std::size_t later = std::min(first + 9, truth.frames.size() - 1);
    std::printf("  axis off by %.2f mm, step %.3f degrees\n",
                1000 * axis_error(position.centre, truth.camera_from_mesh(first),
                                  truth.camera_from_mesh(later)),
                position.step_deg);
    const int scene = truth.frames[first].scene_id;
    while (first + 1 < truth.frames.size() && truth.frames[first].scene_id == scene) ++first;
  }
}

/// How far the poses of the views are from the truth.
void print_poses(const modeling::AlignedScan& scan, const Truth& truth,
                 const Pose& mesh_from_model) {
  double worst = 0, worst_angle = 0;
  for (const modeling::PosedView& view : scan.views) {
    const Pose there = truth.camera_from_mesh(view.id);
    const Pose error = there.inverse() * view.camera_from_object * mesh_from_model.inverse();
    worst = std::max(worst, error.translation.norm());
    worst_angle = std::max(worst_angle, vector_from_rotation(error.rotation).norm());
  }
  std::printf("  poses within %.2f mm and %.2f degrees of the truth (symmetries not considered)\n",
              1000 * worst, worst_angle * 180 / M_PI);
}

double share_within(const std::vector<float>& distances, float most) {
  const double near = std::ranges::count_if(distances, [most](float d) { return d <= most; });
  return near / std::max<std::size_t>(1, distances.size());
}

void print_surface(const PointCloud& surface, const Truth& truth) {
  constexpr float kNear = 0.004f;
  const std::vector<float> off = distances(surface, truth.surface);
  const PointCloud shown = in_sight(truth.surface, truth.frames);
  std::printf(
      "  surface error: median %.2f mm, 95 %% %.2f mm; completeness of what was in sight, within 4 "
      "mm: %.1f %%\n",
      1000 * quantile(off, 0.5), 1000 * quantile(off, 0.95),
      100 * share_within(distances(shown, surface), kNear));
}

constexpr double kMinCount = 50;  // errors of a bin that counts
constexpr double kMillimetres = 1000;

/// One kind of error: of range or of normals.
struct Kind {
  const char* name;
  const char* unit_name;
  double unit;
  const NoiseCurve& fitted;
  std::vector<modeling::NoiseBin> held_out;  // those that count

  double predicted(const modeling::NoiseBin& bin) const {
    return fitted(bin.edge_distance, bin.angle);
  }
};

std::vector<modeling::NoiseBin> well_filled(std::vector<modeling::NoiseBin> bins) {
  std::erase_if(bins, [](const modeling::NoiseBin& bin) { return bin.count < kMinCount; });
  return bins;
}

/// The factor by which predictions are off: root mean square of its logarithm over all errors.
double factor_off(const Kind& kind) {
  double squares = 0, count = 0;
  for (const modeling::NoiseBin& bin : kind.held_out) {
    squares += bin.count * std::pow(std::log(kind.predicted(bin) / bin.sigma), 2);
    count += bin.count;
  }
  return std::exp(std::sqrt(squares / std::max(1.0, count)));
}

using Value = std::function<double(const modeling::NoiseBin&)>;

std::vector<modeling::NoiseBin> sorted(std::vector<modeling::NoiseBin> bins, const Value& by) {
  std::ranges::stable_sort(bins, {}, by);
  return bins;
}

/// Observed over predicted errors: bins by rising prediction, in ten groups of about equal counts.
draw::Series observed_over_predicted(const Kind& kind) {
  const auto predicted = [&kind](const modeling::NoiseBin& bin) { return kind.predicted(bin); };
  const std::vector<modeling::NoiseBin> bins = sorted(kind.held_out, predicted);
  double all = 0;
  for (const modeling::NoiseBin& bin : bins) all += bin.count;
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
draw::Series series_of(const Kind& kind, const std::string& name,
                       bool (*kept)(const modeling::NoiseBin&), const Value& x, const Value& y) {
  draw::Series series{name, {}, {}};
  for (const modeling::NoiseBin& bin : sorted(kind.held_out, x)) {
    if (!kept(bin)) continue;
    series.x.push_back(x(bin));
    series.y.push_back(kind.unit * y(bin));
  }
  return series;
}

bool far_from_edges(const modeling::NoiseBin& bin) {
  return bin.edge_distance >= 0.015 && bin.edge_distance <= 0.025;
}
bool somewhat_slanted(const modeling::NoiseBin& bin) {
  return bin.angle >= 30 / kDegrees && bin.angle < 37.5 / kDegrees;
}
double degrees(const modeling::NoiseBin& bin) { return kDegrees * bin.angle; }
double millimetres(const modeling::NoiseBin& bin) { return kMillimetres * bin.edge_distance; }

void save_plots(const Kind& kind, const draw::Series& law, const std::string& start,
                const std::string& model) {
  const Value observed = [](const modeling::NoiseBin& bin) { return bin.sigma; };
  const Value fitted = [&kind](const modeling::NoiseBin& bin) { return kind.predicted(bin); };
  const auto curves = [&](bool (*kept)(const modeling::NoiseBin&), const Value& x) {
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

/// Learns a model's noise from every second view and prints what it predicts beside the errors of
/// the other views and the simulated sensor's law. Writes six plots to `plots` unless it is empty.
void measure_noise(const ModelSource& model, const std::vector<modeling::PosedView>& views,
                   const std::string& name, const std::string& plots, int num_threads) {
  std::vector<modeling::PosedView> half[2];
  for (std::size_t i = 0; i < views.size(); ++i) half[i % 2].push_back(views[i]);
  ModelSource learned = model;
  learned.normal_variance.clear();
  modeling::learn_noise(learned, half[0], num_threads);
  const modeling::SurfaceObservations seen =
      modeling::observe_surface(model.surface, half[1], num_threads);
  const Kind range{"range noise", "mm", kMillimetres, learned.noise.range,
                   well_filled(seen.range_bins)};
  const Kind normals{"noise of normals", "degrees", kDegrees, learned.noise.normal,
                     well_filled(seen.normal_bins)};
  const draw::Series law = series_of(range, "simulator's law", far_from_edges, degrees,
                                     [&seen](const modeling::NoiseBin& bin) {
                                       return sim::published_axial_noise(seen.depth, bin.angle);
                                     });
  std::printf(
      "  range noise 15 to 25 mm from edges, mm: angle, fitted, held-out views, simulator's law\n");
  for (const modeling::NoiseBin& bin : range.held_out) {
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

/// Writes the model, in the frame of the mesh, into the library.
void save(ModelSource model, const PointCloud& surface, const Truth& truth, int number,
          const ModelsArguments& a) {
  model.name = io::clean_model_name(truth.name);
  model.number = number;
  model.surface.points = surface.points;
  model.surface.normals = surface.normals;
  model.symmetry = modeling::find_symmetries(model.surface, model.diameter, a.common.threads);
  model.symmetry_origin = SymmetryOrigin::found;
  std::printf("  symmetries: %s\n", modeling::describe(model.symmetry).c_str());
  or_throw(io::save_model(a.library, model, a.common.threads));
}

void measure(const std::string& folder, int number, const ModelsArguments& a) {
  const Truth truth = read_truth(folder, a.split);
  const Stopwatch watch;
  const modeling::AlignedScan aligned = align_scan_of(folder, a.split, a.step_deg, a.common);
  ModelSource model = or_throw(modeling::model_source_from_views(aligned.views, "scan", 1), folder);
  std::printf("%s: %zu views, %.1f s\n", truth.name.c_str(), aligned.views.size(), watch.seconds());

  const modeling::PosedView& first = aligned.views.front();
  const Pose mesh_from_model =
      truth.camera_from_mesh(first.id).inverse() * first.camera_from_object;
  const PointCloud surface = moved(model.surface, mesh_from_model);
  print_axes(aligned, truth);
  print_poses(aligned, truth, mesh_from_model);
  print_surface(surface, truth);
  for (const auto& warnings : {aligned.warnings, model.warnings}) {
    for (const std::string& w : warnings) std::printf("  warning: %s\n", w.c_str());
  }
  measure_noise(model, aligned.views, truth.name, a.plots, a.common.threads);
  if (!a.library.empty()) save(std::move(model), surface, truth, number, a);
}

void bench_models(const ModelsArguments& a) {
  int number = 0;
  for (const std::string& folder : a.scans) measure(folder, ++number, a);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1024);
}

}  // namespace

void add_models_experiment(CLI::App& program) {
  const auto [command, a] = add_command(
      program, "models", "Compare models from simulated scans with the true meshes", bench_models);
  command.add_option("scans", a.scans, "Folders that `bpa simulate turntable` wrote")->required();
  add_split_option(command, a.split);
  add_option(command, "--step-deg", a.step_deg,
             "Assumed turn of the table between images, degrees");
  add_option(command, "--plots", a.plots, "Write plots of the noise here", "DIR");
  add_option(command, "--library", a.library,
             "Write the models here, in the frames of the meshes, numbered from 1 as listed",
             "DIR");
}

}  // namespace bpa::cli
