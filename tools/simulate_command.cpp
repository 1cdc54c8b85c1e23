// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa simulate: piles of objects and turntable scans, written as BOP data sets.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/base/random.hpp"
#include "core/io/bop_writer.hpp"
#include "core/io/mesh_file.hpp"
#include "core/sim/scenes.hpp"
#include "core/sim/turntable.hpp"
#include "tools/command.hpp"
#include "tools/option_fields.hpp"
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

Status simulate_scenes(SimulateArguments a) {
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

  std::vector<std::vector<double>> fractions(a.scenes);
  const Status written = run_all("scenes", a.scenes, a.common.threads,
                                 [&](int i) { return write_scene(a, stage, i, fractions[i]); });
  if (!written.ok()) return written;
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
  add_split_option(command, a.split);
  command.add_option("--scale", a.scale, "Metres of one unit of the meshes' files")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_common_options(command, a.common);
}

template <class Value>
void add_range(CLI::App& command, const char* name, Value& low, Value& high, const char* text) {
  const auto set = [&low, &high](const std::vector<Value>& range) {
    low = range[0];
    high = range[1];
  };
  command.add_option_function<std::vector<Value>>(name, set, text)
      ->delimiter(',')
      ->expected(2)
      ->type_name("MIN,MAX");
}

void add_object_options(CLI::App& command, SimulateArguments& a) {
  auto* meshes =
      command.add_option("--meshes", a.meshes, "Folder of PLY, OBJ or STL meshes instead of ours");
  meshes->type_name("DIR");
  command.add_option("--models", a.models, "Only these of the household objects")
      ->excludes(meshes)
      ->type_name("LIST");
  command
      .add_option("--model-error", a.model_error,
                  "Largest change of an object's length along each axis against its model, "
                  "as a fraction")
      ->check(CLI::Range(0.0, 0.2))
      ->capture_default_str();
  command
      .add_option("--look-alikes", a.look_alikes,
                  "Most distractors of a scene with an object's shape and other measures, "
                  "which are not in the truth")
      ->check(CLI::Range(0, 20))
      ->capture_default_str();
}

void add_scenes(CLI::App& simulate, const std::shared_ptr<SimulateArguments>& a, Action& action) {
  CLI::App& command = *simulate.add_subcommand("scenes", "Piles of objects on a table");
  add_output_options(command, *a);
  command.add_option("--scenes", a->scenes, "Number of scenes")
      ->check(CLI::Range(1, 999999))
      ->capture_default_str();
  add_range(command, "--objects", a->scene.min_objects, a->scene.max_objects,
            "Fewest and most objects of a scene; 10,14 if not given");
  add_range(command, "--clutter", a->scene.min_clutter, a->scene.max_clutter,
            "Range of clutter, 0.6,1 if not given; 0 = apart on the table, 1 = heap");
  add_object_options(command, *a);
  add_options(command, a->scene,
              {{"--views", "views"},
               {"--shots", "shots"},
               {"--empty", "empty_share"},
               {"--distractors", "distractor_share"},
               {"--border", "border_share"},
               {"--misregistration", "misregistration"},
               {"--calibration-error", "calibration_error"}});
  command.callback([&action, a] { action = [a] { return simulate_scenes(*a); }; });
}

void add_turntable(CLI::App& simulate, const std::shared_ptr<SimulateArguments>& a,
                   Action& action) {
  CLI::App& command = *simulate.add_subcommand("turntable", "An object turned before a camera");
  add_output_options(command, *a);
  auto* mesh = command.add_option("--mesh", a->mesh, "PLY, OBJ or STL mesh")->type_name("FILE");
  command.add_option("--object", a->object, "One of the household objects instead")
      ->excludes(mesh)
      ->type_name("NAME");
  add_options(command, a->turntable,
              {{"--step-deg", "step_deg"}, {"--positions", "resting_positions"}});
  command.callback([&action, a] {
    if (a->mesh.empty() == a->object.empty()) {
      throw CLI::ValidationError("object", "give one of --mesh and --object");
    }
    action = [a] { return simulate_turntable(*a); };
  });
}

}  // namespace

void add_simulate_command(CLI::App& program, Action& action) {
  CLI::App& simulate = *program.add_subcommand("simulate", "RGB-D frames with truth, as BOP sets");
  simulate.require_subcommand(1);
  const auto a = std::make_shared<SimulateArguments>();
  add_scenes(simulate, a, action);
  add_turntable(simulate, a, action);
}

}  // namespace bpa::cli
