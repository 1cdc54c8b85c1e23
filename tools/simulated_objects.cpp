// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/simulated_objects.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/io/file_bytes.hpp"
#include "tools/mesh_input.hpp"

namespace bpa::cli {
namespace fs = std::filesystem;
namespace {

sim::SimulatedObject object_from_file(const std::string& path, io::MeshFile file) {
  constexpr double kSmallest = 0.005, kLargest = 3;  // metres
  if (file.mesh.triangles.empty()) throw Failure(invalid_argument(path + " has no triangles"));
  const double diameter = sim::diameter(file.mesh);
  if (!(diameter >= kSmallest && diameter <= kLargest)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  " is %.3g m across; it must be between 0.005 and 3 m. For files in millimetres "
                  "give --scale 0.001",
                  diameter);
    throw Failure(invalid_argument(path + text));
  }
  const std::string name = fs::path(path).stem().string();
  print_warnings(name, file.warnings);
  return sim::object_from_mesh(name, std::move(file.mesh));
}

std::vector<sim::SimulatedObject> read_objects(const std::vector<std::string>& paths,
                                               double scale) {
  std::vector<io::MeshFile> files = read_meshes(paths, scale);
  std::vector<sim::SimulatedObject> objects;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    objects.push_back(object_from_file(paths[i], std::move(files[i])));
  }
  return objects;
}

/// The objects of a BOP data set's folder of models, in millimetres, with their symmetries.
std::vector<sim::SimulatedObject> read_bop_objects(const std::string& folder) {
  constexpr double kMetresPerMillimetre = 0.001;
  std::vector<sim::SimulatedObject> objects;
  for (const io::BopModel& model : or_throw(io::read_bop_models_folder(folder))) {
    objects.push_back(read_objects({model.path}, kMetresPerMillimetre).front());
    objects.back().name = model.name;
    objects.back().symmetry = model.symmetry;
  }
  return objects;
}

std::vector<std::string> meshes_in(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string path = entry.path().string();
    if (std::ranges::count(io::mesh_extensions(), io::lower_extension(path)) > 0) {
      paths.push_back(path);
    }
  }
  if (paths.empty()) {
    throw Failure(
        {StatusCode::not_found, folder + " holds no PLY, OBJ, STL, GLB, glTF or DAE mesh"});
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

sim::SimulatedObject read_object(const std::string& path, double scale) {
  return read_objects({path}, scale).front();
}

std::vector<sim::SimulatedObject> named_objects(const std::vector<std::string>& names,
                                                int num_threads) {
  std::vector<sim::SimulatedObject> objects = sim::household_objects(names, num_threads);
  for (const std::string& name : names) {
    if (std::ranges::count(objects, name, &sim::SimulatedObject::name) > 0) continue;
    throw Failure({StatusCode::not_found, "there is no object of ours " + name +
                                              "; bpa simulate scenes --help lists their names"});
  }
  return objects;
}

std::vector<sim::SimulatedObject> chosen_objects(const ObjectChoice& a, int num_threads) {
  std::error_code error;  // read_objects() says what is wrong with the folder
  if (!a.meshes.empty() && fs::exists(fs::path(a.meshes) / "models_info.json", error)) {
    return read_bop_objects(a.meshes);
  }
  if (!a.meshes.empty()) return read_objects(meshes_in(a.meshes), a.scale);
  if (a.models.empty()) return sim::household_objects(num_threads);
  return named_objects(a.models, num_threads);
}

void write_models(const std::string& out, const std::vector<sim::SimulatedObject>& objects) {
  std::vector<io::BopMesh> meshes;
  for (const sim::SimulatedObject& object : objects) {
    meshes.push_back({static_cast<int>(meshes.size()) + 1, object.name, sim::diameter(object.mesh),
                      object.symmetry, object.mesh});
  }
  or_throw(io::write_bop_models(out, meshes));
}

std::vector<io::BopInstanceRecord> records_of(const sim::SimulatedFrame& frame) {
  std::vector<io::BopInstanceRecord> records;
  for (const sim::SimulatedInstance& instance : frame.instances) {
    io::BopInstanceRecord& record = records.emplace_back();
    record.obj_id = instance.object + 1;
    record.camera_from_object = instance.camera_from_object;
    record.mask_visible = sim::visible_mask(frame, static_cast<int>(records.size()) - 1);
    record.visible_fraction = instance.visibility.fraction();
  }
  return records;
}

void add_object_options(CLI::App& command, ObjectChoice& objects) {
  auto* meshes =
      add_option(command, "--meshes", objects.meshes,
                 "Folder of meshes instead of ours: PLY, OBJ, STL, GLB, glTF, DAE. Names and "
                 "symmetries are those of its models_info.json (BOP, millimetres) if it is there",
                 "DIR");
  add_option(
      command, "--models", objects.models,
      "Only these of our objects. Household, all of them if not given: mug, bowl, bottle, can, "
      "cup, tube, funnel, plate, milk_carton, cereal_box, snack_box, spray_bottle, jug, cube, "
      "l_brick, stud_block, gear, banana. Workshop and desk: pen, screwdriver, wrench, scissors, "
      "clamp, spatula, tin, battery, phone, remote, book, soap, sponge, matchbox",
      "LIST")
      ->excludes(meshes)
      ->delimiter(',');
}

void add_sensor_option(CLI::App& command, sim::SensorOptions& sensor, bool& mixed,
                       const std::string& unit) {
  constexpr std::string_view kMixed = "mixed";
  const auto set = [kMixed, &sensor, &mixed](const std::string& name) {
    mixed = name == kMixed;
    sensor.kind = sensor_kind(name).value_or(SensorKind::structured_light);
  };
  std::vector<std::string> names{std::string(kMixed)};
  for (const SensorKind kind : kSensorKinds) names.emplace_back(name_of(kind));
  command
      .add_option_function<std::string>(
          "--sensor", set,
          "Kind of the depth camera, structured_light if not given; mixed = one of them for each " +
              unit)
      ->check(CLI::IsMember(names));
}

}  // namespace bpa::cli
