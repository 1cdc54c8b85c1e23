// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa model: what a library holds, and how models get into it.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "core/draw/model_sheet.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/model_file.hpp"
#include "core/model/occupancy_grid.hpp"
#include "core/model/view_sphere.hpp"
#include "core/modeling/model_source.hpp"
#include "core/modeling/registration.hpp"
#include "core/modeling/symmetry_search.hpp"
#include "tools/command.hpp"
#include "tools/option_fields.hpp"
#include "tools/progress.hpp"
#include "tools/scan_files.hpp"
#include "tools/simulated_views.hpp"

namespace bpa::cli {
namespace {

constexpr double kMetresPerMillimetre = 0.001;

struct ModelArguments {
  CommonOptions common;
  std::string library;
  std::string input;  // a mesh, a data set
  std::string name;
  double scale = 1;
  int number = 0;
  int views = 120;
  std::string symmetry = "find";
  std::string render;          // a PNG
  std::string split = "test";  // of scans
  double step_deg = 10;
  int known_object = 0;  // obj_id when the poses are known
  ModelOptions options;
};

/// Leaves of a model what a simulated sensor sees of its mesh, and learns what that is off by.
void look_at(const TriangleMesh& mesh, const ModelArguments& a, ModelSource& source) {
  if (a.views == 0) return;
  Progress progress(source.name, a.views);
  const std::vector<PosedView> views =
      simulate_views(mesh, a.views, a.common.seed, a.common.threads,
                     [&progress](int done) { progress.show(done, "simulated views"); });
  keep_measured(source, views, a.common.threads);
}

Result<ModelSource> source_from_mesh(const TriangleMesh& mesh, const ModelArguments& a,
                                     const std::string& name, int number) {
  Result<ModelSource> source = model_source_from_mesh(mesh, name, number, a.options);
  if (source.ok()) look_at(mesh, a, *source);
  return source;
}

/// Looks for symmetries, and tells the user, unless that is not wanted.
void add_symmetries(ModelSource& source, const ModelArguments& a) {
  if (a.symmetry == "none") {
    source.symmetry_origin = SymmetryOrigin::declared;
    return;
  }
  source.symmetry = find_symmetries(source.surface, source.diameter, a.common.threads);
  source.symmetry_origin =
      a.symmetry == "confirm" ? SymmetryOrigin::declared : SymmetryOrigin::found;
  if (source.symmetry.trivial()) return;
  std::printf("%s: found symmetries: %s\n", source.name.c_str(), describe(source.symmetry).c_str());
  if (a.symmetry == "confirm") return;
  std::printf(
      "Is that right, colours aside? `bpa model symmetry %s --library %s --confirm` keeps them, "
      "--none drops them.\n",
      source.name.c_str(), a.library.c_str());
}

/// Warns when the library holds a model that looks the same: both would be found in one place.
void warn_of_twins(ModelSource& source, const ModelArguments& a) {
  constexpr double kSameSize = 0.04, kSameShape = 0.97;
  for (const std::string& name : io::list_models(a.library)) {
    const Result<ModelSource> described = io::describe_model(a.library, name);
    if (name == source.name || !described.ok()) continue;
    if (std::abs(described->diameter / source.diameter - 1) > kSameSize) continue;
    const Result<ModelSource> other = io::load_model(a.library, name);
    if (!other.ok()) continue;
    RegistrationOptions options;
    options.tolerance_m = std::max(0.002, 0.015 * source.diameter);
    options.draws = 600;
    options.kept = 4;
    options.num_threads = a.common.threads;
    const auto there = register_surfaces(source.surface, other->surface, options);
    if (there.empty() || there.front().overlap < kSameShape) continue;
    const auto back = register_surfaces(other->surface, source.surface, options);
    if (back.empty() || back.front().overlap < kSameShape) continue;
    source.warnings.push_back("has nearly the same shape as " + name +
                              ": one may be taken for the other");
  }
}

/// `bpa model symmetry`: the user's answer.
Status set_symmetry(ModelArguments a) {
  Result<ModelSource> model = io::load_model(a.library, a.name);
  if (!model.ok()) return model.status();
  if (a.symmetry == "none") model->symmetry = {};
  if (a.symmetry != "find") {
    model->symmetry_origin = SymmetryOrigin::declared;
    auto occupancy = io::load_occupancy(a.library, a.name);
    if (!occupancy.ok()) return occupancy.status();
    model->occupancy = std::move(*occupancy);
    if (Status s = io::save_model(a.library, *model, a.common.threads); !s.ok()) return s;
  }
  std::printf("%s: symmetries: %s%s\n", a.name.c_str(), describe(model->symmetry).c_str(),
              model->symmetry_origin == SymmetryOrigin::found ? " (found, not confirmed)" : "");
  return {};
}

void print_saved(const ModelSource& model, const std::string& library) {
  std::printf("%s: number %d, diameter %.1f mm, %zu points -> %s\n", model.name.c_str(),
              model.number, 1000 * model.diameter, model.surface.size(),
              (std::filesystem::path(library) / model.name).c_str());
  for (const std::string& warning : model.warnings) {
    std::fprintf(stderr, "warning: %s: %s\n", model.name.c_str(), warning.c_str());
  }
}

/// The number of a model of that name, else the first that is free. Broken models have none.
int choose_number(const std::string& library, const std::string& name) {
  int largest = 0;
  for (const std::string& other : io::list_models(library)) {
    const Result<ModelSource> model = io::describe_model(library, other);
    if (!model.ok()) continue;
    if (other == name) return model->number;
    largest = std::max(largest, model->number);
  }
  return largest + 1;
}

Result<ModelSource> source_from_file(const ModelArguments& a) {
  if (io::lower_extension(a.input) != "pcd") {
    const Result<TriangleMesh> mesh = io::read_mesh(a.input, a.scale);
    if (!mesh.ok()) return mesh.status();
    if (!mesh->triangles.empty()) {
      return source_from_mesh(*mesh, a, a.name, a.number);
    }
  }
  const Result<PointCloud> cloud = io::read_point_cloud(a.input, a.scale);
  if (!cloud.ok()) return cloud.status();
  Result<ModelSource> source = model_source_from_points(*cloud, a.name, a.number, a.options);
  if (source.ok() && source->complete) look_at(squares_of(source->surface), a, *source);
  return source;
}

/// Prefixes a failure with the input, unless it is named already.
Status about(const std::string& input, Status status) {
  if (status.message.find(input) == std::string::npos) {
    status.message = input + ": " + status.message;
  }
  return status;
}

/// Completes a new model and adds it to the library.
Status add_to_library(ModelSource source, const ModelArguments& a) {
  source.source = std::filesystem::path(a.input).filename().string();
  if (source.complete) add_symmetries(source, a);
  warn_of_twins(source, a);
  if (Status s = io::save_model(a.library, source, a.common.threads); !s.ok()) return s;
  print_saved(source, a.library);
  return {};
}

Status from_mesh(ModelArguments a) {
  if (a.number == 0) a.number = choose_number(a.library, a.name);
  a.options.num_threads = a.common.threads;
  Result<ModelSource> source = source_from_file(a);
  if (!source.ok()) return about(a.input, source.status());
  return add_to_library(std::move(*source), a);
}

Status from_bop(ModelArguments a) {
  const Result<std::vector<io::BopModel>> models = io::read_bop_models(a.input);
  if (!models.ok()) return models.status();
  a.options.num_threads = a.common.threads;
  Progress progress("models", static_cast<int>(models->size()));
  for (std::size_t i = 0; i < models->size(); ++i) {
    const io::BopModel& model = (*models)[i];
    progress.show(static_cast<int>(i), model.name);
    const Result<TriangleMesh> mesh = io::read_mesh(model.path, kMetresPerMillimetre);
    if (!mesh.ok()) return mesh.status();
    Result<ModelSource> source =
        source_from_mesh(*mesh, a, io::clean_model_name(model.name), model.obj_id);
    if (!source.ok()) {
      return Status(source.status().code, model.path + ": " + source.status().message);
    }
    source->source = std::filesystem::path(model.path).filename().string();
    source->symmetry = model.symmetry;
    source->symmetry_origin = SymmetryOrigin::declared;
    source->diameter = model.diameter;
    if (Status s = io::save_model(a.library, *source, a.common.threads); !s.ok()) return s;
    progress.clear();
    print_saved(*source, a.library);
  }
  return {};
}

Result<std::vector<PosedView>> posed_views(const ModelArguments& a,
                                           std::vector<std::string>& warnings) {
  if (a.known_object > 0) {
    return read_posed_views(a.input, a.split, a.known_object, a.common.threads);
  }
  auto scan = read_scan(a.input, a.split, a.common.threads);
  if (!scan.ok()) return scan.status();
  ScanOptions options;
  options.step_deg = a.step_deg;
  options.seed = a.common.seed;
  options.num_threads = a.common.threads;
  Progress progress(a.name, 2);
  progress.show(0, "centres of rotation");
  Result<AlignedScan> aligned = align_scan(std::move(*scan), options);
  if (!aligned.ok()) return aligned.status();
  progress.clear();
  for (const RestingPosition& p : aligned->positions) {
    std::printf(
        "resting position: turntable %.0f mm away, axis at (%.1f, %.1f, %.1f) mm, step %.2f "
        "degrees\n",
        1000 * p.centre.norm(), 1000 * p.centre.x(), 1000 * p.centre.y(), 1000 * p.centre.z(),
        p.step_deg);
  }
  warnings = std::move(aligned->warnings);
  center_object(aligned->views);
  return std::move(aligned->views);
}

Status from_scans(ModelArguments a) {
  if (a.number == 0) a.number = choose_number(a.library, a.name);
  a.options.num_threads = a.common.threads;
  std::vector<std::string> warnings;
  Result<std::vector<PosedView>> views = posed_views(a, warnings);
  if (!views.ok()) return about(a.input, views.status());
  Result<ModelSource> source =
      model_source_from_views(std::move(*views), a.name, a.number, a.options);
  if (!source.ok()) return source.status();
  source->warnings.insert(source->warnings.begin(), warnings.begin(), warnings.end());
  return add_to_library(std::move(*source), a);
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

Status info(ModelArguments a) {
  const Result<ModelSource> model = io::load_model(a.library, a.name);
  if (!model.ok()) return model.status();
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : model->surface.points) box.extend(point);
  const Eigen::Vector3f size = 1000 * box.sizes();
  std::printf("name        %s\nnumber      %d\nsource      %s\n", model->name.c_str(),
              model->number, model->source.c_str());
  std::printf("diameter    %.1f mm\nsize        %.1f x %.1f x %.1f mm\n", 1000 * model->diameter,
              static_cast<double>(size.x()), static_cast<double>(size.y()),
              static_cast<double>(size.z()));
  std::printf("points      %zu%s%s\n", model->surface.size(),
              model->surface.normals.empty() ? "" : ", normals",
              model->surface.colors.empty() ? "" : ", colours");
  std::printf("symmetries  %s%s\n", describe(model->symmetry).c_str(),
              model->symmetry_origin == SymmetryOrigin::found ? " (found, not confirmed)" : "");
  const NoiseModel& noise = model->noise;
  std::printf("noise       %s; at %.2f m, seen straight on: range %.1f mm, normals %.0f degrees\n",
              noise.fitted ? "fitted" : "the usual", noise.depth,
              1000 * noise.range(kMaxEdgeDistance, 0),
              noise.normal(kMaxEdgeDistance, 0) * 180 / M_PI);
  const auto occupancy = io::load_occupancy(a.library, a.name);
  if (!occupancy.ok()) return occupancy.status();
  print_occupancy(occupancy->get());
  for (const std::string& warning : model->warnings)
    std::printf("warning     %s\n", warning.c_str());
  if (a.render.empty()) return {};
  const auto made = make_object_model(*model, a.common.threads);
  if (!made.ok()) return made.status();
  return io::write_color_png(a.render, draw::model_sheet(**made));
}

Status list(ModelArguments a) {
  const Result<io::LibraryContents> found = io::read_library(a.library, a.common.threads);
  if (!found.ok()) return found.status();
  if (found->models.empty() && found->broken.empty()) {
    return invalid_argument("library " + a.library + " is empty");
  }
  std::printf("%6s  %-28s %12s %8s  %s\n", "number", "name", "diameter", "points", "symmetries");
  for (const ModelSource& model : found->models) {
    std::printf("%6d  %-28s %9.1f mm %8zu  %zu discrete, %zu continuous\n", model.number,
                model.name.c_str(), 1000 * model.diameter, model.surface.size(),
                model.symmetry.discrete.size(), model.symmetry.continuous.size());
  }
  std::fflush(stdout);
  return io::explain_broken(a.library, found->broken);
}

Status remove(ModelArguments a) {
  if (Status s = io::remove_model(a.library, a.name); !s.ok()) return s;
  std::printf("removed %s from %s\n", a.name.c_str(), a.library.c_str());
  return {};
}

using Arguments = std::shared_ptr<ModelArguments>;

/// A subcommand of `bpa model` with the options that all of them have.
CLI::App& add(CLI::App& model, const char* name, const char* description, const Arguments& a,
              Action& action, Status (*run)(ModelArguments)) {
  CLI::App& command = *model.add_subcommand(name, description);
  add_common_options(command, a->common);
  add_library_option(command, a->library);
  command.callback([&action, a, run] { action = [a, run] { return run(*a); }; });
  return command;
}

void add_name(CLI::App& command, const char* option, ModelArguments& a) {
  command.add_option(option, a.name, "Name of the model")->required();
}

void add_views_option(CLI::App& command, ModelArguments& a) {
  command
      .add_option(
          "--views", a.views,
          "Simulated views: surface that no view measures is left out, and noise is learned "
          "from them; 0 = keep all outer surface, with default noise")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
}

/// The options of one object that becomes a model.
void add_new_model_options(CLI::App& command, ModelArguments& a) {
  add_name(command, "--name", a);
  command
      .add_option("--number", a.number,
                  "Number of the model (obj_id); the next free one if not given")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--symmetry", a.symmetry,
                  "find: look for symmetries and use them; confirm: and take them as confirmed; "
                  "none: the object has none")
      ->check(CLI::IsMember({"find", "confirm", "none"}))
      ->capture_default_str();
  add_options(command, a.options, {{"--spacing", "spacing_m"}});
}

void add_from_mesh(CLI::App& model, const Arguments& a, Action& action) {
  CLI::App& command =
      add(model, "from-mesh", "One mesh or point cloud to a model", a, action, from_mesh);
  command.add_option("mesh", a->input, "PLY, OBJ or STL mesh; PLY or PCD point cloud")->required();
  command.add_option("--scale", a->scale, "Metres of one unit of the file; 0.001 for millimetres")
      ->check(CLI::PositiveNumber);
  add_new_model_options(command, *a);
  add_views_option(command, *a);
}

void add_from_bop(CLI::App& model, const Arguments& a, Action& action) {
  CLI::App& command = add(model, "from-bop", "Every model of a BOP data set", a, action, from_bop);
  command.add_option("dataset", a->input, "Folder of the data set")->required();
  add_options(command, a->options, {{"--spacing", "spacing_m"}});
  add_views_option(command, *a);
}

void add_from_scans(CLI::App& model, const Arguments& a, Action& action) {
  CLI::App& command = add(model, "from-scans", "RGB-D views of an object on a turntable to a model",
                          a, action, from_scans);
  command
      .add_option("scans", a->input,
                  "Folder in the BOP layout: each scene is a resting position, image k was taken "
                  "after k steps")
      ->required();
  add_split_option(command, a->split);
  command.add_option("--step-deg", a->step_deg, "Turn of the table between images, degrees")
      ->check(CLI::Range(0.5, 120.0))
      ->capture_default_str();
  command
      .add_option("--known-poses", a->known_object,
                  "Take the poses of this object (obj_id) from scene_gt.json instead: any views, "
                  "no turntable")
      ->check(CLI::PositiveNumber)
      ->type_name("OBJ_ID");
  add_new_model_options(command, *a);
}

void add_symmetry(CLI::App& model, const Arguments& a, Action& action) {
  CLI::App& command = add(model, "symmetry", "Show, confirm or drop the symmetries of a model", a,
                          action, set_symmetry);
  add_name(command, "name", *a);
  auto* confirm = command.add_flag_callback(
      "--confirm", [a] { a->symmetry = "confirm"; }, "The symmetries found are right");
  command
      .add_flag_callback(
          "--none", [a] { a->symmetry = "none"; }, "The object has none")
      ->excludes(confirm);
}

}  // namespace

void add_model_command(CLI::App& program, Action& action) {
  CLI::App& model = *program.add_subcommand("model", "Make, list and remove object models");
  model.require_subcommand(1);
  const auto a = std::make_shared<ModelArguments>();
  add_from_mesh(model, a, action);
  add_from_bop(model, a, action);
  add_from_scans(model, a, action);
  CLI::App& about_one = add(model, "info", "What a library holds of a model", a, action, info);
  add_name(about_one, "name", *a);
  about_one.add_option("--render", a->render, "Write a picture of the model: sides, edges, noise")
      ->type_name("F.png");
  add_symmetry(model, a, action);
  add(model, "list", "The models of a library; exits with 1 if one of them cannot be read", a,
      action, list);
  add_name(add(model, "remove", "Remove a model from a library", a, action, remove), "name", *a);
}

}  // namespace bpa::cli
