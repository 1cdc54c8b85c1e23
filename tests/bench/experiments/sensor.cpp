// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa-experiments sensor: the simulated depth cameras against published figures and against real
// frames.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"
#include "core/draw/sheet.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/sim/scenes.hpp"
#include "tests/bench/experiments/experiments.hpp"
#include "tests/core/sim/depth_statistics.hpp"
#include "tools/search.hpp"

namespace bpa::cli {
namespace {

using Json = nlohmann::json;
using sim::DepthStatistics;

struct SensorArguments {
  CommonOptions common;
  DatasetOptions dataset;
  std::vector<std::string> pcd;
  std::string sheet, json;
  int frames = 8;
};

// --- planes -----------------------------------------------------------------------------------

constexpr double kDepths[] = {0.6, 1.0, 1.5, 2.0};
constexpr double kAngles[] = {0, 15, 30, 45, 60, 75};
constexpr double kRadians = std::numbers::pi / 180;

/// Khoshelham and Elberink 2012, equation 10 with their calibration: 2.85e-5 z^2 / 2 cm, z in cm.
double khoshelham_noise(double depth) { return 1.425e-3 * depth * depth; }

/// Nguyen, Izadi and Lovell 2012, equation 1, pixels.
double nguyen_lateral(double angle) { return 0.8 + 0.035 * angle / (std::numbers::pi / 2 - angle); }

Json bench_planes(const SensorArguments& a) {
  std::printf("planes                  axial noise, mm               edge, pixels    no depth\n");
  std::printf("depth  angle   measured  Nguyen  Khoshelham   measured  Nguyen     %%\n");
  Json rows = Json::array();
  for (const double depth : kDepths) {
    for (const double degrees : kAngles) {
      const double angle = degrees * kRadians;
      const sim::PlaneNoise noise =
          sim::plane_noise(depth, angle, {}, a.common.seed, a.common.threads);
      const double nguyen = sim::published_axial_noise(depth, angle);
      // Khoshelham's figure is for surfaces that face the camera.
      const std::string khoshelham = degrees == 0 ? fixed(1e3 * khoshelham_noise(depth), 2) : "";
      std::printf("%3.1f m  %3.0f deg %8.2f %8.2f %10s %11.2f %8.2f %9.1f\n", depth, degrees,
                  1e3 * noise.axial, 1e3 * nguyen, khoshelham.c_str(), noise.lateral,
                  nguyen_lateral(angle), 100 * noise.missing);
      rows.push_back({{"depth_m", depth},
                      {"angle_deg", degrees},
                      {"axial_m", noise.axial},
                      {"published_axial_m", nguyen},
                      {"lateral_px", noise.lateral},
                      {"published_lateral_px", nguyen_lateral(angle)},
                      {"missing", noise.missing}});
    }
  }
  return rows;
}

/// The axial standard deviation of depth that is published of a sensor, metres. For a surface at
/// `depth` metres seen at `angle` radians from its normal. Nothing where none is published.
std::optional<double> published_noise(const sim::SensorOptions& options, double depth,
                                      double angle) {
  if (options.kind == SensorKind::time_of_flight) {
    return sim::published_axial_noise(options.time_of_flight, depth, angle);
  }
  if (options.kind != SensorKind::active_stereo || angle > 0) return std::nullopt;
  const sim::ActiveStereoOptions& stereo = options.active_stereo;
  return stereo.disparity_noise * depth * depth / (stereo.infrared_focal * stereo.baseline);
}

/// The other kinds against what is published of them.
Json bench_other_planes(const SensorArguments& a, SensorKind kind) {
  sim::SensorOptions options;
  options.kind = kind;
  std::printf("\n%-20s    axial noise, mm     edge, pixels\n", std::string(name_of(kind)).c_str());
  std::printf("depth  angle   measured  published     measured\n");
  Json rows = Json::array();
  for (const double depth : kDepths) {
    for (const double degrees : kAngles) {
      const double angle = degrees * kRadians;
      const sim::PlaneNoise noise =
          sim::plane_noise(depth, angle, options, a.common.seed, a.common.threads);
      const std::optional<double> published = published_noise(options, depth, angle);
      std::printf("%3.1f m  %3.0f deg %8.2f %10s %12.2f\n", depth, degrees, 1e3 * noise.axial,
                  published ? fixed(1e3 * *published, 2).c_str() : "", noise.lateral);
      rows.push_back({{"depth_m", depth},
                      {"angle_deg", degrees},
                      {"axial_m", noise.axial},
                      {"lateral_px", noise.lateral}});
      if (published) rows.back()["published_axial_m"] = *published;
    }
  }
  return rows;
}

// --- frames -----------------------------------------------------------------------------------

std::vector<Input> read_real_frames(const SensorArguments& a) {
  DetectArguments of_set, of_clouds;
  of_set.dataset = a.dataset;
  of_clouds.pcd = a.pcd;
  std::vector<Input> frames;
  for (const DetectArguments& source : {of_set, of_clouds}) {
    for (const io::BopFrame& entry : list_inputs(source)) {
      Input& input = frames.emplace_back(read_input(source, entry));
      input.name = "real " + std::filesystem::path(input.name).filename().string();
    }
  }
  return frames;
}

double median_depth(const Frame& frame) {
  std::vector<float> depths = frame.depth;
  std::erase(depths, 0.0f);
  if (depths.empty()) return 1;
  return median(depths);
}

/// A simulated table seen by the same camera from about as far.
Input simulated_beside(const sim::Stage& stage, const Frame& real, std::uint64_t seed,
                       int num_threads) {
  sim::SceneOptions options;
  options.camera = real.camera;
  options.min_clutter = 0;
  options.max_clutter = 0.5;
  options.min_objects = 4;
  options.max_objects = 9;
  options.bin_share = 0;
  options.border_share = 0;
  options.min_distance = options.max_distance = std::clamp(median_depth(real), 0.5, 3.0);
  options.max_elevation_deg = 50;
  sim::SimulatedScene scene = sim::simulate_scene(stage, options, seed, num_threads);
  return {"simulated", std::move(scene.frames.front().frame), {}};
}

constexpr struct {
  const char* name;
  double DepthStatistics::*value;
  double scale;       // of the printed value
  int width, digits;  // of the column
} kStatistics[] = {{"missing", &DepthStatistics::missing, 100, 6, 1},
                   {"small_holes", &DepthStatistics::small_holes, 1, 9, 1},
                   {"left_gap_px", &DepthStatistics::left_gap, 1, 8, 1},
                   {"right_gap_px", &DepthStatistics::right_gap, 1, 7, 1},
                   {"roughness", &DepthStatistics::roughness, 1, 10, 3},
                   {"near_correlation", &DepthStatistics::near_correlation, 1, 8, 2},
                   {"far_correlation", &DepthStatistics::far_correlation, 1, 6, 2}};

void print_row(const std::string& name, const DepthStatistics& row) {
  std::printf("%-24s", name.substr(0, 24).c_str());
  for (const auto& s : kStatistics) {
    std::printf(" %*.*f", s.width, s.digits, s.scale * row.*s.value);
  }
  std::printf("\n");
}

Json to_json(const DepthStatistics& row) {
  Json json;
  for (const auto& s : kStatistics) json[s.name] = row.*s.value;
  return json;
}

DepthStatistics mean_of(const std::vector<DepthStatistics>& rows) {
  DepthStatistics mean;
  for (const auto& s : kStatistics) {
    for (const DepthStatistics& row : rows) mean.*s.value += row.*s.value / rows.size();
  }
  return mean;
}

Json bench_frames(const SensorArguments& a) {
  const std::vector<Input> real = read_real_frames(a);
  if (real.empty()) return {{"frames", 0}};
  const sim::Stage stage(sim::household_objects(a.common.threads), a.common.threads);
  std::printf(
      "\nframes                    no     small    gap left  right  roughness  correlation of\n"
      "                       depth %%     holes   of edges, px      px disp.   1.5 px   5 px\n");
  std::vector<io::ColorImage> cells;
  std::vector<DepthStatistics> real_rows, simulated_rows;
  const int count = std::min(static_cast<int>(real.size()), a.frames);
  Progress progress("frames", count);
  for (int k = 0; k < count; ++k) {
    progress.show(k);
    // Evenly over all that were given.
    const Input& frame = real[k * real.size() / count];
    const Input beside =
        simulated_beside(stage, frame.frame, sim::scene_seed(a.common.seed, k), a.common.threads);
    progress.clear();
    real_rows.push_back(sim::depth_statistics(frame.frame));
    simulated_rows.push_back(sim::depth_statistics(beside.frame));
    print_row(frame.name, real_rows.back());
    print_row("  simulated", simulated_rows.back());
    for (const Input* one : {&frame, &beside}) {
      cells.push_back(draw::color_beside_depth(one->frame, one->name));
    }
  }
  print_row("mean of the real ones", mean_of(real_rows));
  print_row("mean of the simulated", mean_of(simulated_rows));
  if (!a.sheet.empty()) or_throw(io::write_color_png(a.sheet, draw::contact_sheet(cells, 2, 1280)));
  return {{"frames", count},
          {"real", to_json(mean_of(real_rows))},
          {"simulated", to_json(mean_of(simulated_rows))}};
}

void bench_sensor(const SensorArguments& a) {
  const bool with_frames = !a.dataset.folder.empty() || !a.pcd.empty();
  if (!a.sheet.empty() && !with_frames) {
    throw CLI::ValidationError("--sheet", "needs real frames: --bop or --pcd");
  }
  Json json = {{"format", "bpa sensor bench"}, {"version", 1}, {"planes", bench_planes(a)}};
  for (const SensorKind kind : kSensorKinds) {
    if (kind == SensorKind::structured_light) continue;
    json[std::string(name_of(kind))] = bench_other_planes(a, kind);
  }
  if (with_frames) json["frames"] = bench_frames(a);
  if (!a.json.empty()) or_throw(io::write_file(a.json, json.dump(1) + "\n"));
}

}  // namespace

void add_sensor_experiment(CLI::App& program) {
  const auto [command, a] = add_command(
      program, "sensor",
      "Compare the simulated sensors with published noise, the Kinect with real frames too",
      bench_sensor);
  add_option(command, "--bop", a.dataset.folder, "Real frames: folder of a BOP data set", "DIR");
  add_split_options(command, a.dataset);
  add_option(command, "--pcd", a.pcd, "Real frames: organised PCD clouds", "FILE...");
  add_option(command, "--frames", a.frames, "Largest number of real frames, taken evenly from all")
      ->check(CLI::Range(1, 1000));
  add_option(command, "--sheet", a.sheet,
             "Write a picture of real frames (left) beside simulated ones (right)", "FILE");
  add_option(command, "--json", a.json, "Write the figures as JSON", "FILE");
}

}  // namespace bpa::cli
