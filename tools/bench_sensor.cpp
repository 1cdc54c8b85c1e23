// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa bench sensor: the simulated depth camera against published figures and against real frames.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/draw/sheet.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/io/pcd_file.hpp"
#include "core/sim/depth_statistics.hpp"
#include "core/sim/scenes.hpp"
#include "tools/bench.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace {

using Json = nlohmann::json;
using sim::DepthStatistics;

struct SensorArguments {
  CommonOptions common;
  std::string bop, split = "test";
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
      std::printf("%3.1f m  %3.0f deg %8.2f %8.2f ", depth, degrees, 1e3 * noise.axial,
                  1e3 * nguyen);
      // Theirs is for surfaces that face the camera.
      if (degrees == 0) {
        std::printf("%10.2f", 1e3 * khoshelham_noise(depth));
      } else {
        std::printf("%10s", "");
      }
      std::printf(" %11.2f %8.2f %9.1f\n", noise.lateral, nguyen_lateral(angle),
                  100 * noise.missing);
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

// --- frames -----------------------------------------------------------------------------------

struct NamedFrame {
  std::string name;
  Frame frame;
};

Result<std::vector<NamedFrame>> read_real_frames(const SensorArguments& a) {
  std::vector<NamedFrame> frames;
  if (!a.bop.empty()) {
    const auto entries = io::read_bop_frames(a.bop, a.split);
    if (!entries.ok()) return entries.status();
    for (const io::BopFrame& entry : *entries) {
      Result<Frame> frame = io::load_bop_frame(entry);
      if (!frame.ok()) return frame.status();
      frames.push_back({"real " + frame->frame_id, std::move(*frame)});
    }
  }
  for (const std::string& path : a.pcd) {
    const Result<io::PcdCloud> cloud = io::read_pcd(path);
    if (!cloud.ok()) return cloud.status();
    if (!cloud->organised()) {
      std::printf("%s is left out: it is not organised\n", path.c_str());
      continue;
    }
    Result<io::OrganisedFrame> organised = io::frame_from_organised_cloud(*cloud);
    if (!organised.ok()) {
      return Status(organised.status().code, path + ": " + organised.status().message);
    }
    const std::size_t slash = path.find_last_of('/');
    frames.push_back({"real " + path.substr(slash == std::string::npos ? 0 : slash + 1),
                      std::move(organised->frame)});
  }
  for (NamedFrame& frame : frames) clean_depth(frame.frame);
  return frames;
}

double median_depth(const Frame& frame) {
  std::vector<float> depths;
  for (const float z : frame.depth) {
    if (z > 0) depths.push_back(z);
  }
  if (depths.empty()) return 1;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

/// A simulated table seen by the same camera from about as far.
NamedFrame simulated_beside(const sim::Stage& stage, const Frame& real, std::uint64_t seed,
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
  return {"simulated", std::move(scene.frames.front().frame)};
}

constexpr int kStatistics = 7;
using Row = std::array<double, kStatistics>;
constexpr const char* kStatisticNames[kStatistics] = {
    "missing",   "small_holes",      "left_gap_px",    "right_gap_px",
    "roughness", "near_correlation", "far_correlation"};

Row row_of(const DepthStatistics& s) {
  return {s.missing,   s.small_holes,      s.left_gap,       s.right_gap,
          s.roughness, s.near_correlation, s.far_correlation};
}

void print_row(const std::string& name, const Row& r) {
  std::printf("%-24s %6.1f %9.1f %8.1f %7.1f %10.3f %8.2f %6.2f\n", name.substr(0, 24).c_str(),
              100 * r[0], r[1], r[2], r[3], r[4], r[5], r[6]);
}

Json to_json(const Row& row) {
  Json json;
  for (int i = 0; i < kStatistics; ++i) json[kStatisticNames[i]] = row[static_cast<std::size_t>(i)];
  return json;
}

Row mean_of(const std::vector<Row>& rows) {
  Row mean{};
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      mean[i] += row[i] / static_cast<double>(rows.size());
    }
  }
  return mean;
}

Result<Json> bench_frames(const SensorArguments& a) {
  Result<std::vector<NamedFrame>> real = read_real_frames(a);
  if (!real.ok()) return real.status();
  if (real->empty()) return Json{{"frames", 0}};
  const sim::Stage stage(sim::household_objects(a.common.threads), a.common.threads);
  std::printf(
      "\nframes                    no     small    gap left  right  roughness  correlation of\n"
      "                       depth %%     holes   of edges, px      px disp.   1.5 px   5 px\n");
  std::vector<io::ColorImage> cells;
  std::vector<Row> real_rows, simulated_rows;
  const int count = std::min(static_cast<int>(real->size()), a.frames);
  Progress progress("frames", count);
  for (int k = 0; k < count; ++k) {
    progress.show(k);
    // Evenly over all that were given.
    const NamedFrame& frame =
        (*real)[static_cast<std::size_t>(k) * real->size() / static_cast<std::size_t>(count)];
    const NamedFrame beside =
        simulated_beside(stage, frame.frame, sim::scene_seed(a.common.seed, k), a.common.threads);
    progress.clear();
    real_rows.push_back(row_of(sim::depth_statistics(frame.frame)));
    simulated_rows.push_back(row_of(sim::depth_statistics(beside.frame)));
    print_row(frame.name, real_rows.back());
    print_row("  simulated", simulated_rows.back());
    for (const NamedFrame* one : {&frame, &beside})
      cells.push_back(draw::color_beside_depth(one->frame, one->name));
  }
  print_row("mean of the real ones", mean_of(real_rows));
  print_row("mean of the simulated", mean_of(simulated_rows));
  if (!a.sheet.empty()) {
    const Status status = io::write_color_png(a.sheet, draw::contact_sheet(cells, 2, 1280));
    if (!status.ok()) return status;
  }
  return Json{{"frames", count},
              {"real", to_json(mean_of(real_rows))},
              {"simulated", to_json(mean_of(simulated_rows))}};
}

Status bench_sensor(const SensorArguments& a) {
  Json json = {{"format", "bpa sensor bench"}, {"version", 1}, {"planes", bench_planes(a)}};
  if (!a.bop.empty() || !a.pcd.empty()) {
    const Result<Json> frames = bench_frames(a);
    if (!frames.ok()) return frames.status();
    json["frames"] = *frames;
  }
  return a.json.empty() ? Status() : io::write_file(a.json, json.dump(1) + "\n");
}

}  // namespace

void add_bench_sensor(CLI::App& bench, Action& action) {
  CLI::App& command = *bench.add_subcommand(
      "sensor", "Compare the simulated Kinect with published noise and real frames");
  const auto a = std::make_shared<SensorArguments>();
  command.add_option("--bop", a->bop, "Real frames: folder of a BOP data set")->type_name("DIR");
  add_split_option(command, a->split);
  command.add_option("--pcd", a->pcd, "Real frames: organised PCD clouds")->type_name("FILE...");
  command.add_option("--frames", a->frames, "Largest number of real frames, taken evenly from all")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      .add_option("--sheet", a->sheet,
                  "Write a picture of real frames (left) beside simulated ones (right)")
      ->type_name("FILE");
  command.add_option("--json", a->json, "Write the figures as JSON")->type_name("FILE");
  add_common_options(command, a->common);
  command.callback([&action, a] {
    if (!a->sheet.empty() && a->bop.empty() && a->pcd.empty()) {
      throw CLI::ValidationError("--sheet", "needs real frames: --bop or --pcd");
    }
    action = [a] { return bench_sensor(*a); };
  });
}

}  // namespace bpa::cli
