// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa simulate: piles of objects and turntable scans, written as BOP data sets.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>

#include <CLI/CLI.hpp>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/io/bop_writer.hpp"
#include "core/io/mesh_file.hpp"
#include "core/sim/scenes.hpp"
#include "core/sim/turntable.hpp"
#include "tools/command.hpp"
#include "tools/progress.hpp"

namespace bpa::cli {
namespace fs = std::filesystem;
namespace {

constexpr double kDepthUnitMm = 1;  // what such a camera delivers

struct SimulateArguments {
  CommonOptions common;
  std::string out, meshes, mesh, object;
  std::string split = "test";
  std::string models;
  int scenes = 30;
  double scale = 1;
  double model_error = 0;
  int look_alikes = 0;
  std::vector<int> objects;
  std::vector<double> clutter;
  sim::SceneOptions scene;
  sim::TurntableOptions turntable;
};

Result<sim::SimulatedObject> read_object(const std::string& path, double scale) {
  constexpr double kSmallest = 0.005, kLargest = 3;  // metres
  Result<TriangleMesh> mesh = io::read_mesh(path, scale);
  if (!mesh.ok()) return mesh.status();
  if (mesh->triangles.empty()) return invalid_argument(path + " has no triangles");
  const double diameter = sim::diameter(*mesh);
  if (!(diameter >= kSmallest && diameter <= kLargest)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  " is %.3g m across; it must be between 0.005 and 3 m. For files in millimetres "
                  "give --scale 0.001",
                  diameter);
    return invalid_argument(path + text);
  }
  return sim::object_from_mesh(fs::path(path).stem().string(), std::move(mesh).value());
}

Result<std::vector<sim::SimulatedObject>> read_objects(const std::string& folder, double scale) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".ply" || extension == ".obj" || extension == ".stl") {
      paths.push_back(entry.path().string());
    }
  }
  if (paths.empty()) {
    return Status(StatusCode::not_found, folder + " holds no PLY, OBJ or STL mesh");
  }
  std::sort(paths.begin(), paths.end());
  std::vector<sim::SimulatedObject> objects;
  for (const std::string& path : paths) {
    Result<sim::SimulatedObject> object = read_object(path, scale);
    if (!object.ok()) return object.status();
    objects.push_back(std::move(object).value());
  }
  return objects;
}

Result<std::vector<sim::SimulatedObject>> chosen_objects(const SimulateArguments& a) {
  if (!a.meshes.empty()) return read_objects(a.meshes, a.scale);
  if (a.models.empty()) return sim::household_objects(a.common.threads);
  const std::vector<std::string> names = split_commas(a.models);
  std::vector<sim::SimulatedObject> objects = sim::household_objects(names, a.common.threads);
  for (const std::string& name : names) {
    const bool found = std::any_of(objects.begin(), objects.end(),
                                   [&name](const auto& object) { return object.name == name; });
    if (!found) return Status(StatusCode::not_found, "there is no household object " + name);
  }
  return objects;
}

Status write_models(const std::string& out, const std::vector<sim::SimulatedObject>& objects) {
  std::vector<io::BopMesh> meshes;
  for (const sim::SimulatedObject& object : objects) {
    meshes.push_back({static_cast<int>(meshes.size()) + 1, object.name, sim::diameter(object.mesh),
                      object.symmetry, object.mesh});
  }
  return io::write_bop_models(out, meshes);
}

Status add_frame(io::BopSceneWriter& writer, int im_id, const sim::SimulatedFrame& frame) {
  std::vector<io::BopInstanceRecord> records;
  for (std::size_t i = 0; i < frame.instances.size(); ++i) {
    const sim::SimulatedInstance& instance = frame.instances[i];
    io::BopInstanceRecord record;
    record.obj_id = instance.object + 1;
    record.camera_from_object = instance.camera_from_object;
    record.mask_visible = sim::visible_mask(frame, static_cast<int>(i));
    record.visible_fraction = instance.visibility.fraction();
    records.push_back(std::move(record));
  }
  return writer.add(im_id, frame.frame, records);
}

Status write_scene(const SimulateArguments& a, const sim::Stage& stage, int index,
                   std::vector<double>& fractions) {
  // One thread for each scene: a pile of bodies is hard to share among threads.
  const sim::SimulatedScene scene =
      sim::simulate_scene(stage, a.scene, sim::scene_seed(a.common.seed, index), 1);
  io::BopSceneWriter writer(a.out, a.split, index + 1, kDepthUnitMm);
  for (std::size_t view = 0; view < scene.frames.size(); ++view) {
    const sim::SimulatedFrame& frame = scene.frames[view];
    if (Status s = add_frame(writer, static_cast<int>(view), frame); !s.ok()) return s;
    for (const sim::SimulatedInstance& instance : frame.instances) {
      fractions.push_back(instance.visibility.fraction());
    }
  }
  return writer.finish();
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

// Two of each object, so much longer or shorter that they are other things.
std::vector<sim::SimulatedObject> make_look_alikes(const std::vector<sim::SimulatedObject>& objects,
                                                   std::uint64_t seed) {
  constexpr double kDifference = 0.12;
  std::vector<sim::SimulatedObject> out;
  for (std::size_t i = 0; i < 2 * objects.size(); ++i) {
    out.push_back(sim::made_inexactly(objects[i / 2], kDifference, RandomStream(seed, 2000 + i)()));
  }
  return out;
}

Status simulate_scenes(SimulateArguments a) {
  const auto range = [](const auto& given, auto& low, auto& high) {
    if (given.size() == 2) {
      low = given[0];
      high = given[1];
    }
  };
  range(a.objects, a.scene.min_objects, a.scene.max_objects);
  range(a.clutter, a.scene.min_clutter, a.scene.max_clutter);
  if (Status s = validate(a.scene); !s.ok()) return s;
  if (a.scene.min_objects > a.scene.max_objects) {
    return invalid_argument("--objects MIN,MAX: MIN must not be greater than MAX");
  }
  Result<std::vector<sim::SimulatedObject>> objects = chosen_objects(a);
  if (!objects.ok()) return objects.status();
  if (Status s = write_models(a.out, *objects); !s.ok()) return s;
  std::vector<sim::SimulatedObject> look_alikes;
  if (a.look_alikes > 0) {
    look_alikes = make_look_alikes(*objects, a.common.seed);
    a.scene.max_distractors = a.look_alikes;
  }
  for (std::size_t i = 0; a.model_error > 0 && i < objects->size(); ++i) {
    (*objects)[i] = sim::made_inexactly(std::move((*objects)[i]), a.model_error,
                                        RandomStream(a.common.seed, 1000 + i)());
  }
  const sim::Stage stage(std::move(objects).value(), a.common.threads, std::move(look_alikes));

  Progress progress("simulate", a.scenes);
  progress.show(0);
  std::vector<Status> status(a.scenes);
  std::vector<std::vector<double>> fractions(a.scenes);
  std::mutex mutex;
  int done = 0;
  parallel_for(a.scenes, a.common.threads, [&](int i) {
    status[i] = write_scene(a, stage, i, fractions[i]);
    const std::lock_guard lock(mutex);
    progress.show(++done, "scene " + std::to_string(i + 1));
  });
  progress.clear();
  for (const Status& s : status) {
    if (!s.ok()) return s;
  }
  std::vector<double> all;
  for (const auto& f : fractions) all.insert(all.end(), f.begin(), f.end());
  std::printf("%d scenes in %s/%s, %zu models\n", a.scenes, a.out.c_str(), a.split.c_str(),
              stage.objects().size());
  print_visible_fractions(std::move(all));
  return {};
}

Result<sim::SimulatedObject> turntable_object(const SimulateArguments& a) {
  if (!a.mesh.empty()) return read_object(a.mesh, a.scale);
  std::vector<sim::SimulatedObject> found =
      sim::household_objects(std::vector<std::string>{a.object}, a.common.threads);
  if (found.empty()) {
    return Status(StatusCode::not_found, "there is no household object " + a.object);
  }
  return std::move(found.front());
}

Status simulate_turntable(const SimulateArguments& a) {
  if (Status s = validate(a.turntable); !s.ok()) return s;
  const Result<sim::SimulatedObject> object = turntable_object(a);
  if (!object.ok()) return object.status();
  if (Status s = write_models(a.out, {*object}); !s.ok()) return s;
  Progress progress("simulate", 2);
  progress.show(0, "views");
  const sim::TurntableScan scan =
      sim::simulate_turntable(*object, a.turntable, a.common.seed, a.common.threads);
  progress.show(1, "files");
  // One BOP scene for each resting position; images are numbered in steps of the turn.
  std::size_t view = 0;
  int positions = 0;
  while (view < scan.views.size()) {
    const int position = scan.views[view].resting_position;
    io::BopSceneWriter writer(a.out, a.split, position + 1, kDepthUnitMm);
    for (int im_id = 0; view < scan.views.size() && scan.views[view].resting_position == position;
         ++view, ++im_id) {
      if (Status s = add_frame(writer, im_id, scan.views[view].frame); !s.ok()) return s;
    }
    if (Status s = writer.finish(); !s.ok()) return s;
    ++positions;
  }
  progress.clear();
  std::printf(
      "%zu views of %s in %d resting positions in %s/%s; the true mesh is "
      "models/obj_000001.ply\n",
      scan.views.size(), object->name.c_str(), positions, a.out.c_str(), a.split.c_str());
  return {};
}

void add_output_options(CLI::App& command, SimulateArguments& a) {
  command.add_option("--out", a.out, "Folder of the data set to write")
      ->required()
      ->type_name("DIR");
  command.add_option("--split", a.split, "Split to write")
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--scale", a.scale, "Metres of one unit of the meshes' files")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

}  // namespace

void add_simulate_command(CLI::App& program, Action& action) {
  CLI::App& simulate = *program.add_subcommand("simulate", "RGB-D frames with truth, as BOP sets");
  simulate.require_subcommand(1);
  const auto a = std::make_shared<SimulateArguments>();

  CLI::App& scenes = *simulate.add_subcommand("scenes", "Piles of objects on a table");
  add_output_options(scenes, *a);
  scenes.add_option("--scenes", a->scenes, "Number of scenes")
      ->check(CLI::Range(1, 999999))
      ->capture_default_str();
  scenes
      .add_option("--objects", a->objects, "Fewest and most objects of a scene; 10,14 if not given")
      ->delimiter(',')
      ->expected(2)
      ->type_name("MIN,MAX");
  scenes
      .add_option("--clutter", a->clutter,
                  "Range of clutter, 0.6,1 if not given; 0 = apart on the table, 1 = heap")
      ->delimiter(',')
      ->expected(2)
      ->type_name("MIN,MAX");
  auto* meshes = scenes.add_option("--meshes", a->meshes, "Meshes of your own instead of ours");
  meshes->type_name("DIR");
  scenes.add_option("--models", a->models, "Only these of the household objects")
      ->excludes(meshes)
      ->type_name("LIST");
  scenes.add_option("--views", a->scene.views, "Places that each scene is seen from")
      ->capture_default_str();
  scenes.add_option("--shots", a->scene.shots, "Frames from each place, with other noise")
      ->capture_default_str();
  scenes.add_option("--empty", a->scene.empty_share, "Share of scenes with an empty table")
      ->capture_default_str();
  scenes
      .add_option("--distractors", a->scene.distractor_share,
                  "Share of scenes with nothing but other things")
      ->capture_default_str();
  scenes
      .add_option("--border", a->scene.border_share,
                  "Share of scenes with an object cut by the image's border")
      ->capture_default_str();
  scenes.add_option("--misregistration", a->scene.kinect.misregistration,
                    "Shift of colour against depth, pixels");
  scenes
      .add_option(
          "--model-error", a->model_error,
          "What objects are longer or shorter than their models along each axis, as a share")
      ->check(CLI::Range(0.0, 0.2))
      ->capture_default_str();
  scenes
      .add_option(
          "--look-alikes", a->look_alikes,
          "Most things of a scene that look like the objects but have other measures, and are "
          "not in the truth")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
  scenes
      .add_option("--calibration-error", a->scene.kinect.calibration_error,
                  "Smooth error of the sensor's disparity, pixels; 0.4 is 1 cm at 1 m")
      ->capture_default_str();
  add_common_options(scenes, a->common);
  scenes.callback([&action, a] { action = [a] { return simulate_scenes(*a); }; });

  CLI::App& turntable = *simulate.add_subcommand("turntable", "An object turned before a camera");
  add_output_options(turntable, *a);
  auto* mesh = turntable.add_option("--mesh", a->mesh, "PLY, OBJ or STL mesh")->type_name("FILE");
  turntable.add_option("--object", a->object, "One of the household objects instead")
      ->excludes(mesh)
      ->type_name("NAME");
  turntable.add_option("--step-deg", a->turntable.step_deg, "Turn between two views, degrees")
      ->capture_default_str();
  turntable
      .add_option("--positions", a->turntable.resting_positions, "Ways the object is put down")
      ->capture_default_str();
  add_common_options(turntable, a->common);
  turntable.callback([&action, a] {
    if (a->mesh.empty() == a->object.empty()) {
      throw CLI::ValidationError("object", "give one of --mesh and --object");
    }
    action = [a] { return simulate_turntable(*a); };
  });
}

}  // namespace bpa::cli
