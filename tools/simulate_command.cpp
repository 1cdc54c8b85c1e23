// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa simulate: piles of objects and turntable scans, written as BOP data sets.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/base/random.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/sim/scenes.hpp"
#include "core/sim/turntable.hpp"
#include "tools/mesh_input.hpp"
#include "tools/simulated_objects.hpp"

namespace bpa::cli {
namespace fs = std::filesystem;
namespace {

struct SimulateArguments {
  CommonOptions common;
  std::string out, mesh, object;
  std::string split = "test";
  ObjectChoice objects;
  int scenes = 30;
  double model_error = 0;
  int look_alikes = 0, other_prints = 0;
  sim::SceneOptions scene;
  sim::TurntableOptions turntable;
};

void add_frame(io::BopSceneWriter& writer, int im_id, const sim::SimulatedFrame& frame) {
  or_throw(writer.add(im_id, frame.frame, records_of(frame), frame.camera_from_world));
}

/// Returns the visible fractions of the instances.
std::vector<double> write_scene(const SimulateArguments& a, const sim::Stage& stage,
                                const sim::SceneOptions& options, int index) {
  // One thread for each scene: a pile of bodies is hard to share among threads.
  const sim::SimulatedScene scene =
      sim::simulate_scene(stage, options, sim::scene_seed(a.common.seed, index), 1);
  io::BopSceneWriter writer(a.out, a.split, index + 1, kDepthUnitMm);
  std::vector<double> fractions;
  for (std::size_t view = 0; view < scene.frames.size(); ++view) {
    add_frame(writer, static_cast<int>(view), scene.frames[view]);
    for (const sim::SimulatedInstance& instance : scene.frames[view].instances) {
      fractions.push_back(instance.visibility.fraction());
    }
  }
  or_throw(writer.finish());
  return fractions;
}

void print_visible_fractions(std::vector<double> fractions) {
  if (fractions.empty()) return;
  std::sort(fractions.begin(), fractions.end());
  int counts[10] = {};
  for (const double f : fractions) ++counts[std::min(9, static_cast<int>(10 * f))];
  std::printf("visible fraction of %zu instances: median %.2f; by tenths:", fractions.size(),
              fractions[fractions.size() / 2]);
  for (const int count : counts) std::printf(" %d", count);
  std::printf("\n");
}

// Two of each object, with lengths that differ so much that they are other objects.
std::vector<sim::SimulatedObject> make_look_alikes(const std::vector<sim::SimulatedObject>& objects,
                                                   std::uint64_t seed) {
  constexpr double kDifference = 0.12;
  std::vector<sim::SimulatedObject> out;
  for (std::size_t i = 0; i < 2 * objects.size(); ++i) {
    out.push_back(sim::made_inexactly(objects[i / 2], kDifference, RandomStream(seed, 2000 + i)()));
  }
  return out;
}

void simulate_scenes(const SimulateArguments& a) {
  sim::SceneOptions options = a.scene;
  or_throw(validate(options));
  if (options.min_objects > options.max_objects) {
    throw Failure(invalid_argument("--objects MIN,MAX: MIN must not be greater than MAX"));
  }
  std::vector<sim::SimulatedObject> objects = chosen_objects(a.objects, a.common.threads),
                                    look_alikes;
  if (options.ambiguous_share > 0 &&
      std::ranges::all_of(objects, [](const auto& object) { return object.telltales.empty(); })) {
    throw Failure(invalid_argument("--ambiguous needs the household object mug"));
  }
  write_models(a.out, objects);
  if (a.look_alikes > 0) look_alikes = make_look_alikes(objects, a.common.seed);
  for (std::size_t i = 0; a.other_prints > 0 && i < 2 * objects.size(); ++i) {
    look_alikes.push_back(
        sim::printed_otherwise(objects[i / 2], RandomStream(a.common.seed, 3000 + i)()));
  }
  if (!look_alikes.empty()) options.max_distractors = std::max(a.look_alikes, a.other_prints);
  for (std::size_t i = 0; a.model_error > 0 && i < objects.size(); ++i) {
    objects[i] = sim::made_inexactly(std::move(objects[i]), a.model_error,
                                     RandomStream(a.common.seed, 1000 + i)());
  }
  const sim::Stage stage(std::move(objects), a.common.threads, std::move(look_alikes));

  std::vector<std::vector<double>> fractions(a.scenes);
  run_all("scenes", a.scenes, a.common.threads,
          [&](int i) { fractions[i] = write_scene(a, stage, options, i); });
  std::vector<double> all;
  for (const auto& f : fractions) all.insert(all.end(), f.begin(), f.end());
  std::printf("%d scenes in %s/%s, %zu models\n", a.scenes, a.out.c_str(), a.split.c_str(),
              stage.objects().size());
  print_visible_fractions(std::move(all));
}

void simulate_turntable(const SimulateArguments& a) {
  if (a.mesh.empty() == a.object.empty()) {
    throw CLI::ValidationError("object", "give one of --mesh and --object");
  }
  or_throw(validate(a.turntable));
  const sim::SimulatedObject object = a.mesh.empty()
                                          ? named_objects({a.object}, a.common.threads).front()
                                          : read_object(a.mesh, a.objects.scale);
  write_models(a.out, {object});
  Progress progress("simulate", 2);
  progress.show(0, "views");
  const sim::TurntableScan scan =
      sim::simulate_turntable(object, a.turntable, a.common.seed, a.common.threads);
  progress.show(1, "files");
  // One BOP scene for each resting position; images are numbered in steps of the turn.
  int positions = 0;
  for (auto view = scan.views.begin(); view != scan.views.end(); ++positions) {
    const int position = view->resting_position;
    io::BopSceneWriter writer(a.out, a.split, position + 1, kDepthUnitMm);
    for (int im_id = 0; view != scan.views.end() && view->resting_position == position; ++view) {
      add_frame(writer, im_id++, view->frame);
    }
    or_throw(writer.finish());
  }
  progress.clear();
  std::printf(
      "%zu views of %s in %d resting positions in %s/%s; the true mesh is "
      "models/obj_000001.ply\n",
      scan.views.size(), object.name.c_str(), positions, a.out.c_str(), a.split.c_str());
}

/// A subcommand of `bpa simulate` with the options that both of them have.
std::pair<CLI::App&, SimulateArguments&> add(CLI::App& simulate, const char* name,
                                             const char* description,
                                             void (*run)(const SimulateArguments&)) {
  const auto added = add_command(simulate, name, description, run);
  const auto& [command, a] = added;
  add_option(command, "--out", a.out, "Folder of the data set to write", "DIR")->required();
  add_split_option(command, a.split);
  add_unit_options(command, a.objects.scale);
  return added;
}

void add_scenes(CLI::App& simulate) {
  const auto [command, a] = add(simulate, "scenes", "Piles of objects on a table", simulate_scenes);
  add_option(command, "--scenes", a.scenes, "Number of scenes")->check(CLI::Range(1, 999999));
  add_range_option(command, "--objects", a.scene.min_objects, a.scene.max_objects,
                   "Fewest and most objects of a scene; 10,14 if not given");
  add_range_option(command, "--clutter", a.scene.min_clutter, a.scene.max_clutter,
                   "Range of clutter, 0.6,1 if not given; 0 = apart on the table, 1 = heap");
  add_range_option(command, "--foreign", a.scene.min_distractors, a.scene.max_distractors,
                   "Fewest and most distractors beside the objects, at most 12; 0,2 if not given. "
                   "They are not in the truth");
  const auto set_size = [&scene = a.scene](const std::vector<int>& size) {
    scene.camera = sim::camera_of_size(size[0], size[1]);
  };
  command
      .add_option_function<std::vector<int>>(
          "--size", set_size,
          "Size of the images, pixels; 640,480 if not given. The focal length grows with the width")
      ->delimiter(',')
      ->expected(2)
      ->check(CLI::Range(160, 4096))
      ->type_name("WIDTH,HEIGHT");
  add_range_option(command, "--focal", a.scene.min_focal, a.scene.max_focal,
                   "Range of the focal length, pixels; 525 for each 640 of the width if not given");
  add_range_option(command, "--distance", a.scene.min_distance, a.scene.max_distance,
                   "Range from the camera to the middle of the pile, metres; 0.6,1.4 if not given");
  add_range_option(command, "--elevation", a.scene.min_elevation_deg, a.scene.max_elevation_deg,
                   "Range of the camera above the table, degrees; 25,65 if not given");
  add_sensor_option(command, a.scene.sensor, a.scene.mixed_sensors, "scene");
  add_object_options(command, a.objects);
  add_option(command, "--model-error", a.model_error,
             "Largest change of an object's length along each axis against its model, as a "
             "fraction")
      ->check(CLI::Range(0.0, 0.2))
      ->capture_default_str();
  add_option(command, "--look-alikes", a.look_alikes,
             "Most distractors of a scene with an object's shape and other measures, which are "
             "not in the truth")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  add_option(command, "--other-prints", a.other_prints,
             "Most distractors of a scene with an object's shape and measures and another print, "
             "which are not in the truth")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  add_options(command, options_of(a.scene),
              {{"--views", "views"},
               {"--shots", "shots"},
               {"--empty", "empty_share"},
               {"--distractors", "distractor_share"},
               {"--border", "border_share"},
               {"--ambiguous", "ambiguous_share"},
               {"--equal", "equal_share"},
               {"--kinds", "max_kinds"},
               {"--misregistration", "misregistration"},
               {"--exposure-spread", "exposure_spread"},
               {"--white-balance-spread", "white_balance_spread"},
               {"--lateral-noise", "lateral_noise"},
               {"--edge-gaps", "edge_gaps"},
               {"--calibration-error", "calibration_error"}});
}

void add_turntable(CLI::App& simulate) {
  const auto [command, a] =
      add(simulate, "turntable", "An object turned before a camera", simulate_turntable);
  auto* mesh =
      add_option(command, "--mesh", a.mesh, "PLY, OBJ, STL, GLB, glTF or DAE mesh", "FILE");
  add_option(command, "--object", a.object, "One of our objects instead", "NAME")->excludes(mesh);
  add_options(command, options_of(a.turntable),
              {{"--step-deg", "step_deg"}, {"--positions", "resting_positions"}});
}

}  // namespace

void add_simulate_command(CLI::App& program) {
  CLI::App& simulate = *program.add_subcommand("simulate", "RGB-D frames with truth, as BOP sets");
  simulate.require_subcommand(1);
  add_scenes(simulate);
  add_sequence_command(simulate);
  add_turntable(simulate);
}

}  // namespace bpa::cli
