// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa model: what a library holds, and how models get into it.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "core/draw/sheet.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/model/model_index.hpp"
#include "core/model/occupancy_grid.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/model_source.hpp"
#include "core/modeling/registration.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "tools/mesh_input.hpp"
#include "tools/posed_views.hpp"

namespace bpa::cli {
namespace {

constexpr double kMetresPerMillimetre = 0.001;

struct ModelArguments {
  CommonOptions common;
  std::string library;
  std::string input;  // a mesh, a data set
  std::string name;
  double scale = 0;  // metres of a unit; 0 = guess
  int number = 0;
  int views = kSimulatedViews;
  std::string symmetry = "find";
  std::string render;          // a PNG
  std::string split = "test";  // of scans
  double step_deg = 10;
  int known_object = 0;  // obj_id when the poses are known
  modeling::ModelOptions options;

  modeling::ModelOptions options_with_threads() const {
    modeling::ModelOptions out = options;
    out.num_threads = common.threads;
    return out;
  }
};

ModelSource source_from_mesh(const io::MeshFile& file, const std::string& path,
                             const ModelArguments& a, const std::string& name, int number) {
  ModelSource source = or_throw(
      modeling::model_source_from_mesh(file.mesh, name, number, a.options_with_threads()), path);
  look_at(file.mesh, a.views, a.common, source);
  source.warnings.insert(source.warnings.end(), file.warnings.begin(), file.warnings.end());
  return source;
}

/// Looks for symmetries, and tells the user, unless that is not wanted.
void add_symmetries(ModelSource& source, const ModelArguments& a) {
  if (a.symmetry == "none") {
    source.symmetry_origin = SymmetryOrigin::declared;
    return;
  }
  source.symmetry = modeling::find_symmetries(source.surface, source.diameter, a.common.threads);
  source.symmetry_origin =
      a.symmetry == "confirm" ? SymmetryOrigin::declared : SymmetryOrigin::found;
  if (source.symmetry.trivial()) return;
  std::printf("%s: found symmetries: %s\n", source.name.c_str(),
              modeling::describe(source.symmetry).c_str());
  if (a.symmetry == "confirm") return;
  std::printf(
      "Is that right, colours aside? `bpa model symmetry %s --library %s --confirm` keeps them, "
      "--none drops them.\n",
      source.name.c_str(), a.library.c_str());
}

/// Warns when the library holds a model that looks the same: both would be found in one place.
void warn_of_twins(ModelSource& source, const ModelArguments& a) {
  for (const std::string& name : io::list_models(a.library)) {
    // Its description alone first: that is quick to read.
    const Result<ModelSource> described = io::describe_model(a.library, name);
    if (name == source.name || !described.ok() || !modeling::same_size(source, *described))
      continue;
    const Result<ModelSource> other = io::load_model(a.library, name);
    if (!other.ok() || !modeling::same_shape(source, *other, a.common.threads)) continue;
    source.warnings.push_back("has nearly the same shape as " + name +
                              ": one may be taken for the other");
  }
}

std::string symmetry_text(const ModelSource& model) {
  return modeling::describe(model.symmetry) +
         (model.symmetry_origin == SymmetryOrigin::found ? " (found, not confirmed)" : "");
}

/// `bpa model symmetry`: the user's answer.
void set_symmetry(const ModelArguments& a) {
  ModelSource model = or_throw(io::load_model(a.library, a.name));
  if (a.symmetry == "none") {
    model.symmetry = {};
    if (model.prepared) {  // all else of an index does not depend on the symmetries
      auto index = std::make_shared<ModelIndex>(*model.prepared);
      index->near_symmetries = near_symmetries_of(model, *index);
      model.prepared = std::move(index);
    }
  }
  if (a.symmetry != "find") {
    model.symmetry_origin = SymmetryOrigin::declared;
    model.occupancy = or_throw(io::load_occupancy(a.library, a.name));
    or_throw(io::save_model(a.library, model, a.common.threads));
  }
  std::printf("%s: symmetries: %s\n", a.name.c_str(), symmetry_text(model).c_str());
}

void save(const ModelSource& model, const ModelArguments& a) {
  or_throw(io::save_model(a.library, model, a.common.threads));
  std::printf("%s: number %d, diameter %.1f mm, %zu points -> %s\n", model.name.c_str(),
              model.number, 1000 * model.diameter, model.surface.size(),
              (std::filesystem::path(a.library) / model.name).c_str());
  print_warnings(model.name, model.warnings);
}

/// The number asked for, else that of a readable model of that name, else the first free one.
int choose_number(const ModelArguments& a) {
  if (a.number > 0) return a.number;
  int largest = 0;
  for (const std::string& other : io::list_models(a.library)) {
    const Result<ModelSource> model = io::describe_model(a.library, other);
    if (!model.ok()) continue;
    if (other == a.name) return model->number;
    largest = std::max(largest, model->number);
  }
  return largest + 1;
}

ModelSource source_from_file(const ModelArguments& a, int number) {
  double scale = a.scale;
  if (io::lower_extension(a.input) != "pcd") {
    const io::MeshFile file = read_meshes({a.input}, scale).front();
    const bool ply = io::lower_extension(a.input) == "ply";
    if (!ply || !file.mesh.triangles.empty()) {
      return source_from_mesh(file, a.input, a, a.name, number);
    }
  }
  const PointCloud cloud = or_throw(io::read_point_cloud(a.input, scale > 0 ? scale : 1.0));
  if (scale == 0) assume_metres(a.input, cloud.points);
  ModelSource source = or_throw(
      modeling::model_source_from_points(cloud, a.name, number, a.options_with_threads()), a.input);
  if (source.complete) look_at(squares_of(source.surface), a.views, a.common, source);
  return source;
}

ModelSource source_from_scans(const ModelArguments& a, int number) {
  modeling::AlignedScan scan;
  if (a.known_object > 0) {
    scan.views = read_posed_views(a.input, a.split, a.known_object, a.common.threads);
  } else {
    scan = align_scan_of(a.input, a.split, a.step_deg, a.common);
    modeling::center_object(scan.views);
  }
  for (const modeling::RestingPosition& p : scan.positions) {
    std::printf(
        "resting position: turntable %.0f mm away, axis at (%.1f, %.1f, %.1f) mm, step %.2f "
        "degrees\n",
        1000 * p.centre.norm(), 1000 * p.centre.x(), 1000 * p.centre.y(), 1000 * p.centre.z(),
        p.step_deg);
  }
  ModelSource source = or_throw(modeling::model_source_from_views(
      std::move(scan.views), a.name, number, a.options_with_threads()));
  source.warnings.insert(source.warnings.begin(), scan.warnings.begin(), scan.warnings.end());
  return source;
}

/// Completes a new model and adds it to the library.
void add_to_library(ModelSource source, const ModelArguments& a) {
  source.source = std::filesystem::path(a.input).filename().string();
  if (source.complete) add_symmetries(source, a);
  warn_of_twins(source, a);
  save(source, a);
}

void from_mesh(const ModelArguments& a) {
  add_to_library(source_from_file(a, choose_number(a)), a);
}
void from_scans(const ModelArguments& a) {
  add_to_library(source_from_scans(a, choose_number(a)), a);
}

void from_bop(const ModelArguments& a) {
  const std::vector<io::BopModel> models = or_throw(io::read_bop_models(a.input));
  Progress progress("models", static_cast<int>(models.size()));
  for (std::size_t i = 0; i < models.size(); ++i) {
    const io::BopModel& model = models[i];
    progress.show(static_cast<int>(i), model.name);
    const io::MeshFile file = or_throw(io::read_mesh_file(model.path, kMetresPerMillimetre));
    ModelSource source =
        source_from_mesh(file, model.path, a, io::clean_model_name(model.name), model.obj_id);
    source.source = std::filesystem::path(model.path).filename().string();
    source.symmetry = model.symmetry;
    source.symmetry_origin = SymmetryOrigin::declared;
    source.diameter = model.diameter;
    progress.clear();
    save(source, a);
  }
}

void print_occupancy(const OccupancyGrid* grid) {
  if (grid == nullptr) {
    std::printf("occupancy   none: not made from views\n");
    return;
  }
  int full = 0, walls = 0;
  for (const OccupancyCell& cell : grid->cells) {
    const bool a = occupied(cell.buckets[0]), b = occupied(cell.buckets[1]);
    full += a || b;
    walls += a && b;
  }
  std::printf("occupancy   %d cells of %.1f mm, %d of them with a surface on both sides\n", full,
              static_cast<double>(1000 * grid->cell), walls);
}

void info(const ModelArguments& a) {
  const ModelSource model = or_throw(io::load_model(a.library, a.name));
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : model.surface.points) box.extend(point);
  const Eigen::Vector3d size = (1000 * box.sizes()).cast<double>();
  std::printf("name        %s\nnumber      %d\nsource      %s\n", model.name.c_str(), model.number,
              model.source.c_str());
  std::printf("diameter    %.1f mm\nsize        %.1f x %.1f x %.1f mm\n", 1000 * model.diameter,
              size.x(), size.y(), size.z());
  std::printf("points      %zu%s%s\n", model.surface.size(),
              model.surface.normals.empty() ? "" : ", normals",
              model.surface.colors.empty() ? "" : ", colours");
  std::printf("symmetries  %s\n", symmetry_text(model).c_str());
  const NoiseModel& noise = model.noise;
  std::printf("noise       %s; at %.2f m, seen straight on: range %.1f mm, normals %.0f degrees\n",
              noise.fitted ? "fitted" : "the usual", noise.depth,
              1000 * noise.range(kMaxEdgeDistance, 0),
              noise.normal(kMaxEdgeDistance, 0) * 180 / M_PI);
  print_occupancy(or_throw(io::load_occupancy(a.library, a.name)).get());
  for (const std::string& warning : model.warnings) {
    std::printf("warning     %s\n", warning.c_str());
  }
  if (a.render.empty()) return;
  const auto made = or_throw(make_object_model(model, a.common.threads));
  or_throw(io::write_color_png(a.render, draw::model_sheet(*made)));
}

void list(const ModelArguments& a) {
  const io::LibraryContents found = or_throw(io::read_library(a.library, a.common.threads));
  if (found.models.empty() && found.broken.empty()) {
    throw Failure(invalid_argument("library " + a.library + " is empty"));
  }
  std::printf("%6s  %-28s %12s %8s  %s\n", "number", "name", "diameter", "points", "symmetries");
  for (const ModelSource& model : found.models) {
    std::printf("%6d  %-28s %9.1f mm %8zu  %zu discrete, %zu continuous\n", model.number,
                model.name.c_str(), 1000 * model.diameter, model.surface.size(),
                model.symmetry.discrete.size(), model.symmetry.continuous.size());
  }
  std::fflush(stdout);
  or_throw(io::explain_broken(a.library, found.broken));
}

void remove(const ModelArguments& a) {
  or_throw(io::remove_model(a.library, a.name));
  std::printf("removed %s from %s\n", a.name.c_str(), a.library.c_str());
}

/// A subcommand of `bpa model` with the options that all of them have.
std::pair<CLI::App&, ModelArguments&> add(CLI::App& model, const char* name,
                                          const char* description,
                                          void (*run)(const ModelArguments&)) {
  const auto added = add_command(model, name, description, run);
  add_library_option(added.first, added.second.library);
  return added;
}

void add_name(CLI::App& command, const char* option, ModelArguments& a) {
  add_option(command, option, a.name, "Name of the model")->required();
}

void add_views_option(CLI::App& command, ModelArguments& a) {
  add_option(command, "--views", a.views,
             "Simulated views: surface that no view measures is left out, and noise is learned "
             "from them; 0 = keep all outer surface, with default noise")
      ->check(CLI::Range(0, 1000));
}

/// The options of one object that becomes a model.
void add_new_model_options(CLI::App& command, ModelArguments& a) {
  add_name(command, "--name", a);
  add_option(command, "--number", a.number,
             "Number of the model (obj_id); the next free one if not given")
      ->check(CLI::PositiveNumber);
  add_option(command, "--symmetry", a.symmetry,
             "find: look for symmetries and use them; confirm: and take them as confirmed; "
             "none: the object has none")
      ->check(CLI::IsMember({"find", "confirm", "none"}));
  add_options(command, options_of(a.options), {{"--spacing", "spacing_m"}});
}

void add_from_mesh(CLI::App& model) {
  const auto [command, a] =
      add(model, "from-mesh", "One mesh or point cloud to a model", from_mesh);
  add_option(command, "mesh", a.input,
             "PLY, OBJ, STL, GLB, glTF or DAE mesh, with textures; PLY or PCD point cloud")
      ->required();
  add_unit_options(command, a.scale);
  add_new_model_options(command, a);
  add_views_option(command, a);
}

void add_from_bop(CLI::App& model) {
  const auto [command, a] = add(model, "from-bop", "Every model of a BOP data set", from_bop);
  add_option(command, "dataset", a.input, "Folder of the data set")->required();
  add_options(command, options_of(a.options), {{"--spacing", "spacing_m"}});
  add_views_option(command, a);
}

void add_from_scans(CLI::App& model) {
  const auto [command, a] =
      add(model, "from-scans", "RGB-D views of an object on a turntable to a model", from_scans);
  add_option(command, "scans", a.input,
             "Folder in the BOP layout: each scene is a resting position, image k was taken after "
             "k steps")
      ->required();
  add_split_option(command, a.split);
  add_option(command, "--step-deg", a.step_deg, "Turn of the table between images, degrees")
      ->check(CLI::Range(0.5, 120.0));
  add_option(command, "--known-poses", a.known_object,
             "Take the poses of this object (obj_id) from scene_gt.json instead: any views, no "
             "turntable",
             "OBJ_ID")
      ->check(CLI::PositiveNumber);
  add_new_model_options(command, a);
}

void add_symmetry(CLI::App& model) {
  const auto [command, a] =
      add(model, "symmetry", "Show, confirm or drop the symmetries of a model", set_symmetry);
  add_name(command, "name", a);
  const auto answer = [&to = command, &symmetry = a.symmetry](const char* option, const char* value,
                                                              const char* text) {
    return to.add_flag_callback(
        option, [&symmetry, value] { symmetry = value; }, text);
  };
  answer("--none", "none", "The object has none")
      ->excludes(answer("--confirm", "confirm", "The symmetries found are right"));
}

}  // namespace

void add_model_command(CLI::App& program) {
  CLI::App& model = *program.add_subcommand("model", "Make, list and remove object models");
  model.require_subcommand(1);
  add_from_mesh(model);
  add_from_bop(model);
  add_from_scans(model);
  const auto [about_one, a] = add(model, "info", "What a library holds of a model", info);
  add_name(about_one, "name", a);
  add_option(about_one, "--render", a.render, "Write a picture of the model: sides, edges, noise",
             "F.png");
  add_symmetry(model);
  add(model, "list", "The models of a library; exits with 1 if one of them cannot be read", list);
  const auto [removal, b] = add(model, "remove", "Remove a model from a library", remove);
  add_name(removal, "name", b);
}

}  // namespace bpa::cli
