// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa-experiments alignment: BPA against ICP from noisy starts, on true placements of a data set.
#include <cmath>
#include <cstdio>
#include <list>
#include <map>

#include <nlohmann/json.hpp>

#include "core/cloud/curvature.hpp"
#include "core/cloud/neighbor_grid.hpp"
#include "core/cloud/planes.hpp"
#include "core/draw/plot.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "core/model/model_index.hpp"
#include "tests/bench/experiments/convergence.hpp"
#include "tests/bench/experiments/experiments.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

constexpr float kSpacing = 0.004f;  // Metres.

struct AlignmentArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::string library, plots, json;
  double min_visible = 0.1;
  ConvergenceOptions options;
};

// Models, scenes and what is truly where; lists, so that placements can point into them.
struct Experiment {
  std::map<int, PointCloud> models;
  std::list<PointCloud> scenes;
  std::vector<TruePlacement> placements;
};

void load_models(const AlignmentArguments& a, Experiment& experiment) {
  for (const ModelSource& source : or_throw(io::load_library(a.library))) {
    PointCloud cloud = downsample(source.surface, kSpacing);
    estimate_curvature(cloud, kCurvatureRadius, a.common.threads);
    experiment.models[source.number] = std::move(cloud);
  }
}

// The seen surface without large planes, with curvature.
PointCloud scene_cloud(const Frame& frame, const AlignmentArguments& a) {
  SurfaceMap map = surface_map(frame, {.num_threads = a.common.threads});
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

void load_placements(const AlignmentArguments& a, Experiment& experiment) {
  std::map<int, SymmetryGroup> symmetries;
  for (const io::BopModel& info : or_throw(io::read_bop_models(a.dataset.folder))) {
    symmetries[info.obj_id] = info.symmetry;
  }
  read_true_frames(a.dataset, [&](const TrueFrame& frame) {
    or_throw(validate(frame.frame));
    experiment.scenes.push_back(scene_cloud(frame.frame, a));
    for (const io::BopInstance& instance : frame.truth) {
      const auto model = experiment.models.find(instance.obj_id);
      if (model == experiment.models.end() || instance.visible_fraction < a.min_visible) continue;
      experiment.placements.push_back({&model->second, &experiment.scenes.back(),
                                       instance.camera_from_object, symmetries[instance.obj_id]});
    }
  });
  if (experiment.placements.empty()) {
    throw Failure({StatusCode::not_found, "split " + a.dataset.split + " of " + a.dataset.folder +
                                              " has no true placement of a model in " + a.library});
  }
}

nlohmann::json to_json(const ConvergenceCurve& curve) {
  return {{"mean_min_position_m", curve.position_m}, {"mean_min_angle_rad", curve.angle_rad}};
}

std::string report_json(ConvergenceOptions set, const Experiment& experiment,
                        const ConvergenceResult& result) {
  nlohmann::json options;
  for (const Option& option : options_of(set)) {
    if (option.path == "num_threads") continue;
    std::visit(
        [&]<class Value>(Value value) {
          if constexpr (std::is_pointer_v<Value>) options[option.path] = *value;
        },
        option.value);
  }
  const nlohmann::json report = {{"experiment", "bpa-experiments alignment"},
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
  std::vector<double> ConvergenceCurve::*values;
};

constexpr Quantity kQuantities[] = {
    {"position", "mm", 1e3, &ConvergenceCurve::position_m},
    {"orientation", "degrees", kDegrees, &ConvergenceCurve::angle_rad}};

io::ColorImage plot(const Quantity& quantity, const ConvergenceResult& result) {
  const auto series = [&](const char* name, const ConvergenceCurve& curve) {
    draw::Series out{name, {}, {}};
    for (const double value : curve.*quantity.values) {
      out.x.push_back(out.x.size());
      out.y.push_back(quantity.scale * value);
    }
    return out;
  };
  const double last = result.bpa.position_m.size() - 1;
  return draw::line_plot(
      {std::string("Mean of the least error so far: ") + quantity.name, "iteration", quantity.unit,
       0, last, 0, 0},
      {series("BPA", result.bpa), series("BPA, normals only", result.bpa_normals),
       series("ICP", result.icp)});
}

void print_table(const Experiment& experiment, const ConvergenceResult& result) {
  std::printf("%zu placements, %d trials; mean of the least error so far\n",
              experiment.placements.size(), result.trials);
  std::printf("iteration   BPA mm   deg   normals only mm   deg   ICP mm   deg\n");
  for (std::size_t k = 0; k < result.bpa.position_m.size(); ++k) {
    const auto mm = [k](const ConvergenceCurve& c) { return 1e3 * c.position_m[k]; };
    const auto deg = [k](const ConvergenceCurve& c) { return kDegrees * c.angle_rad[k]; };
    std::printf("%9zu   %6.1f %5.1f   %15.1f %5.1f   %6.1f %5.1f\n", k, mm(result.bpa),
                deg(result.bpa), mm(result.bpa_normals), deg(result.bpa_normals), mm(result.icp),
                deg(result.icp));
  }
}

void bench_alignment(const AlignmentArguments& a) {
  ConvergenceOptions options = a.options;
  options.seed = a.common.seed;
  options.num_threads = a.common.threads;
  or_throw(validate(options));
  Experiment experiment;
  load_models(a, experiment);
  load_placements(a, experiment);
  const ConvergenceResult result = run_convergence(experiment.placements, options);
  print_table(experiment, result);
  const std::string report = report_json(options, experiment, result);
  if (!a.json.empty()) or_throw(io::write_file(a.json, report));
  if (a.plots.empty()) return;
  for (const Quantity& quantity : kQuantities) {
    const std::string path = a.plots + "/alignment_" + quantity.name + ".png";
    or_throw(io::write_color_png(path, plot(quantity, result)));
  }
  or_throw(io::write_file(a.plots + "/alignment.json", report));
}

}  // namespace

void add_alignment_experiment(CLI::App& program) {
  const auto [command, a] =
      add_command(program, "alignment", "Compare BPA with ICP from noisy starts", bench_alignment);
  add_dataset_options(command, a.dataset);
  add_library_option(command, a.library);
  add_option(command, "--plots", a.plots, "Write plots as PNG and alignment.json", "DIR");
  add_option(command, "--json", a.json, "Write the curves as JSON", "FILE");
  add_min_visible_option(command, a.min_visible);
  add_options(command, options_of(a.options),
              {{"--starts", "starts"},
               {"--iterations", "iterations"},
               {"--points", "points"},
               {"--start-position", "start_position_m"},
               {"--start-angle", "start_angle_deg"},
               {"--assign", "assign_m"},
               {"--assign-angle", "assign_deg"},
               {"--sigma", "sigma_m"}});
}

}  // namespace bpa::cli
