// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench alignment: BPA against ICP from noisy starts, on true placements of a data set.
#include <cmath>
#include <cstdio>
#include <list>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/align/convergence.hpp"
#include "core/cloud/curvature.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/planes.hpp"
#include "core/draw/plot.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "core/model/model_index.hpp"
#include "tools/command.hpp"
#include "tools/option_fields.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

constexpr float kSpacing = 0.004f;  // Metres.
constexpr double kDegrees = 180 / M_PI;

struct AlignmentArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string library, plots, json;
  double min_visible = 0.1;
  align::ConvergenceOptions options;
};

// Models, scenes and what is truly where; lists, so that placements can point into them.
struct Experiment {
  std::map<int, PointCloud> models;
  std::list<PointCloud> scenes;
  std::vector<align::TruePlacement> placements;
};

Status load_models(const AlignmentArguments& a, Experiment& experiment) {
  const auto sources = io::load_library(a.library);
  if (!sources.ok()) return sources.status();
  for (const ModelSource& source : *sources) {
    PointCloud cloud = downsample(source.surface, kSpacing);
    estimate_curvature(cloud, kCurvatureRadius, a.common.threads);
    experiment.models[source.number] = std::move(cloud);
  }
  return {};
}

// The seen surface without large planes, with curvature.
PointCloud scene_cloud(const Frame& frame, const AlignmentArguments& a) {
  SurfaceMapOptions options;
  options.num_threads = a.common.threads;
  SurfaceMap map = surface_map(frame, options);
  if (frame.background.empty()) label_background_planes(map, PlaneOptions());
  PointCloud points;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!map.searched[i] || map.normals[i].squaredNorm() == 0) continue;
    points.points.push_back(map.points[i]);
    points.normals.push_back(map.normals[i]);
  }
  PointCloud cloud = downsample(points, kSpacing);
  estimate_curvature(cloud, kCurvatureRadius, a.common.threads);
  return cloud;
}

Status load_placements(const AlignmentArguments& a, Experiment& experiment) {
  const auto frames = io::read_bop_frames(a.dataset.folder, a.dataset.split, a.dataset.scenes);
  if (!frames.ok()) return frames.status();
  const auto infos = io::read_bop_models(a.dataset.folder);
  if (!infos.ok()) return infos.status();
  std::map<int, SymmetryGroup> symmetries;
  for (const io::BopModel& info : *infos) symmetries[info.obj_id] = info.symmetry;
  Progress progress("frames", static_cast<int>(frames->size()));
  for (std::size_t i = 0; i < frames->size(); ++i) {
    progress.show(static_cast<int>(i));
    Result<Frame> frame = io::load_bop_frame((*frames)[i]);
    if (!frame.ok()) return frame.status();
    clean_depth(*frame);
    if (Status status = validate(*frame); !status.ok()) return status;
    experiment.scenes.push_back(scene_cloud(*frame, a));
    for (const io::BopInstance& instance : (*frames)[i].truth) {
      const auto model = experiment.models.find(instance.obj_id);
      if (model == experiment.models.end() || instance.visible_fraction < a.min_visible) continue;
      experiment.placements.push_back({&model->second, &experiment.scenes.back(),
                                       instance.camera_from_object, symmetries[instance.obj_id]});
    }
  }
  if (experiment.placements.empty()) {
    return Status(StatusCode::not_found, "split " + a.dataset.split + " of " + a.dataset.folder +
                                             " has no true placement of a model in " + a.library);
  }
  return {};
}

nlohmann::json to_json(const align::ConvergenceCurve& curve) {
  return {{"mean_min_position_m", curve.position_m}, {"mean_min_angle_rad", curve.angle_rad}};
}

std::string report_json(const AlignmentArguments& a, const Experiment& experiment,
                        const align::ConvergenceResult& result) {
  nlohmann::json options;
  align::ConvergenceOptions copy = a.options;
  copy.visit_fields([&](const char* name, auto& value, const FieldRule&) {
    if (std::string(name) != "num_threads") options[name] = value;
  });
  const nlohmann::json report = {{"experiment", "bpa bench alignment"},
                                 {"placements", experiment.placements.size()},
                                 {"trials", result.trials},
                                 {"options", options},
                                 {"bpa", to_json(result.bpa)},
                                 {"bpa_normals", to_json(result.bpa_normals)},
                                 {"icp", to_json(result.icp)}};
  return report.dump(2) + "\n";
}

// One of the two numbers of all curves, times `scale`.
struct Quantity {
  const char* name;
  const char* unit;
  double scale;
  std::vector<double> align::ConvergenceCurve::*values;
};

constexpr Quantity kPosition = {"position", "mm", 1e3, &align::ConvergenceCurve::position_m};
constexpr Quantity kOrientation = {"orientation", "degrees", kDegrees,
                                   &align::ConvergenceCurve::angle_rad};

Status write_plot(const std::string& folder, const Quantity& quantity,
                  const align::ConvergenceResult& result) {
  const draw::PlotAxes axes{std::string("Mean of the least error so far: ") + quantity.name,
                            "iteration",
                            quantity.unit,
                            0,
                            static_cast<double>(result.bpa.position_m.size() - 1),
                            0,
                            0};
  std::vector<draw::Series> all;
  const auto add = [&](const char* name, const align::ConvergenceCurve& curve) {
    draw::Series series{name, {}, {}};
    for (const double value : curve.*quantity.values) {
      series.x.push_back(static_cast<double>(series.x.size()));
      series.y.push_back(quantity.scale * value);
    }
    all.push_back(series);
  };
  add("BPA", result.bpa);
  add("BPA, normals only", result.bpa_normals);
  add("ICP", result.icp);
  return io::write_color_png(folder + "/alignment_" + quantity.name + ".png",
                             draw::line_plot(axes, all));
}

void print_table(const Experiment& experiment, const align::ConvergenceResult& result) {
  std::printf("%zu placements, %d trials; mean of the least error so far\n",
              experiment.placements.size(), result.trials);
  std::printf("iteration   BPA mm   deg   normals only mm   deg   ICP mm   deg\n");
  for (std::size_t k = 0; k < result.bpa.position_m.size(); ++k) {
    const auto mm = [k](const align::ConvergenceCurve& c) { return 1e3 * c.position_m[k]; };
    const auto deg = [k](const align::ConvergenceCurve& c) { return kDegrees * c.angle_rad[k]; };
    std::printf("%9zu   %6.1f %5.1f   %15.1f %5.1f   %6.1f %5.1f\n", k, mm(result.bpa),
                deg(result.bpa), mm(result.bpa_normals), deg(result.bpa_normals), mm(result.icp),
                deg(result.icp));
  }
}

Status bench_alignment(AlignmentArguments a) {
  a.options.seed = a.common.seed;
  a.options.num_threads = a.common.threads;
  if (Status status = validate(a.options); !status.ok()) return status;
  Experiment experiment;
  if (Status status = load_models(a, experiment); !status.ok()) return status;
  if (Status status = load_placements(a, experiment); !status.ok()) return status;
  const align::ConvergenceResult result = run_convergence(experiment.placements, a.options);
  print_table(experiment, result);
  if (!a.json.empty()) {
    const Status status = io::write_file(a.json, report_json(a, experiment, result));
    if (!status.ok()) return status;
  }
  if (a.plots.empty()) return {};
  for (const Quantity& quantity : {kPosition, kOrientation}) {
    if (Status status = write_plot(a.plots, quantity, result); !status.ok()) return status;
  }
  return io::write_file(a.plots + "/alignment.json", report_json(a, experiment, result));
}

}  // namespace

void add_bench_alignment(CLI::App& bench, Action& action) {
  CLI::App& command = *bench.add_subcommand("alignment", "Compare BPA with ICP from noisy starts");
  const auto a = std::make_shared<AlignmentArguments>();
  add_dataset_options(command, a->dataset);
  add_library_option(command, a->library);
  command.add_option("--plots", a->plots, "Write plots as PNG and alignment.json")
      ->type_name("DIR");
  command.add_option("--json", a->json, "Write the curves as JSON")->type_name("FILE");
  add_min_visible_option(command, a->min_visible);
  add_options(command, a->options,
              {{"--starts", "starts"},
               {"--iterations", "iterations"},
               {"--points", "points"},
               {"--start-position", "start_position_m"},
               {"--start-angle", "start_angle_deg"},
               {"--assign", "assign_m"},
               {"--assign-angle", "assign_deg"},
               {"--sigma", "sigma_m"}});
  add_common_options(command, a->common);
  command.callback([&action, a] { action = [a] { return bench_alignment(*a); }; });
}

}  // namespace bpa::cli
