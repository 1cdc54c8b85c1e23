// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench models: models made from turntable scans against the true meshes.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>

#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include <bpa/core/base/stopwatch.hpp>
#include <bpa/core/cli/bench.hpp>
#include <bpa/core/cli/command.hpp>
#include <bpa/core/cli/scan_files.hpp>
#include <bpa/core/cloud/neighbor_grid.hpp>
#include <bpa/core/io/bop_dataset.hpp>
#include <bpa/core/io/mesh_file.hpp>
#include <bpa/core/model/view_sphere.hpp>

namespace bpa::cli {
namespace {

struct ModelsArguments {
  CommonOptions common;
  std::vector<std::string> scans;
  std::string split = "test";
  double step_deg = 10;
};

double quantile(std::vector<float> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return static_cast<double>(*place);
}

/// The distance of each point to a densely sampled surface: to the tangent plane of the nearest
/// sample that faces the same way; infinite beyond 2 cm.
std::vector<float> distances(const PointCloud& points, const PointCloud& surface) {
  constexpr float kReach = 0.02f, kSampling = 0.002f;
  const NeighborGrid near(surface.points, 0.005f), far(surface.points, kReach);
  std::vector<float> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    float squared = kReach * kReach, distance = std::numeric_limits<float>::infinity();
    const auto consider = [&](int k, float d) {
      const auto j = static_cast<std::size_t>(k);
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

PointCloud moved(const PointCloud& cloud, const Pose& pose) {
  PointCloud out = cloud;
  const Eigen::Matrix3f r = pose.matrix().cast<float>();
  for (auto& p : out.points) p = r * p + pose.translation.cast<float>();
  for (auto& n : out.normals) n = r * n;
  return out;
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
  PointCloud out;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    out.points.push_back(surface.points[i]);
    out.normals.push_back(surface.normals[i]);
  }
  return out;
}

/// How far the found centre of rotation is from the axis about which the truth turns.
double axis_error(const Eigen::Vector3d& centre, const Pose& first, const Pose& later) {
  const Pose motion = later * first.inverse();
  const Eigen::Vector3d axis = vector_from_rotation(motion.rotation).normalized();
  const Eigen::Vector3d off = motion * centre - centre;  // 2 sin(angle / 2) times the distance
  const double angle = vector_from_rotation(motion.rotation).norm();
  return (off - off.dot(axis) * axis).norm() / (2 * std::sin(0.5 * angle));
}

Status measure(const std::string& folder, const ModelsArguments& a) {
  const auto frames = io::read_bop_frames(folder, a.split);
  if (!frames.ok()) return frames.status();
  const auto models = io::read_bop_models(folder);
  if (!models.ok()) return models.status();
  const auto mesh = io::read_mesh(models->front().path, 0.001);
  if (!mesh.ok()) return mesh.status();
  ModelOptions fine;
  fine.spacing_m = 0.001;
  const auto truth = model_source_from_mesh(*mesh, "truth", 1, fine);
  if (!truth.ok()) return truth.status();

  const Stopwatch watch;
  auto scan = read_scan(folder, a.split, a.common.threads);
  if (!scan.ok()) return scan.status();
  TurntableOptions options;
  options.step_deg = a.step_deg;
  options.seed = a.common.seed;
  options.num_threads = a.common.threads;
  auto aligned = align_scan(std::move(*scan), options);
  if (!aligned.ok()) return aligned.status();
  const auto model = model_source_from_views(aligned->views, "scan", 1);
  if (!model.ok()) return model.status();
  const double seconds = watch.seconds();

  std::printf("%s: %zu views, %.1f s\n", models->front().name.c_str(), aligned->views.size(),
              seconds);
  std::size_t place = 0;
  for (const RestingPosition& position : aligned->positions) {
    // The truth of this position: its first frame and one a quarter turn later.
    while (place > 0 && place < frames->size() &&
           (*frames)[place].scene_id == (*frames)[place - 1].scene_id) {
      ++place;
    }
    const std::size_t later = std::min(place + 9, frames->size() - 1);
    std::printf("  axis off by %.2f mm, step %.3f degrees\n",
                1000 * axis_error(position.centre, (*frames)[place].truth[0].camera_from_object,
                                  (*frames)[later].truth[0].camera_from_object),
                position.step_deg);
    ++place;
  }
  const PosedView& first = aligned->views.front();
  const Pose mesh_from_model =
      (*frames)[static_cast<std::size_t>(first.id)].truth[0].camera_from_object.inverse() *
      first.camera_from_object;
  // How far the poses of the views are from the truth.
  double worst = 0, worst_angle = 0;
  for (const PosedView& view : aligned->views) {
    const Pose there = (*frames)[static_cast<std::size_t>(view.id)].truth[0].camera_from_object;
    const Pose error = there.inverse() * view.camera_from_object * mesh_from_model.inverse();
    worst = std::max(worst, error.translation.norm());
    worst_angle = std::max(worst_angle, vector_from_rotation(error.rotation).norm());
  }
  const PointCloud surface = moved(model->surface, mesh_from_model);
  const std::vector<float> off = distances(surface, truth->surface);
  const std::vector<float> missing = distances(in_sight(truth->surface, *frames), surface);
  const auto complete =
      std::count_if(missing.begin(), missing.end(), [](float d) { return d <= 0.004f; });
  std::printf(
      "  poses within %.2f mm and %.2f degrees of the truth (symmetries not considered)\n"
      "  surface error: median %.2f mm, 95 %% %.2f mm; completeness of what was in sight, within 4 "
      "mm: %.1f %%\n",
      1000 * worst, worst_angle * 180 / M_PI, 1000 * quantile(off, 0.5), 1000 * quantile(off, 0.95),
      100.0 * static_cast<double>(complete) / static_cast<double>(missing.size()));
  for (const std::string& w : aligned->warnings) std::printf("  warning: %s\n", w.c_str());
  for (const std::string& w : model->warnings) std::printf("  warning: %s\n", w.c_str());
  return {};
}

Status bench_models(const ModelsArguments& a) {
  for (const std::string& folder : a.scans) {
    if (Status s = measure(folder, a); !s.ok()) return Status(s.code, folder + ": " + s.message);
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::printf("peak memory %.0f MB\n", static_cast<double>(usage.ru_maxrss) / 1024);
  return {};
}

}  // namespace

void add_bench_models(CLI::App& bench, Action& action) {
  const auto a = std::make_shared<ModelsArguments>();
  CLI::App& command =
      *bench.add_subcommand("models", "Models from simulated scans against the true meshes");
  command.add_option("scans", a->scans, "Folders that `bpa simulate turntable` wrote")->required();
  command.add_option("--split", a->split, "Split to read")
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--step-deg", a->step_deg, "What to believe the table turns, degrees")
      ->capture_default_str();
  add_common_options(command, a->common);
  command.callback([&action, a] { action = [a] { return bench_models(*a); }; });
}

}  // namespace bpa::cli
