// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <bpa/core/io/mesh_file.hpp>
#include <bpa/core/io/model_file.hpp>

#include "json_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFormat = "bpa model";
constexpr const char* kModelFile = "model.json";
constexpr const char* kSurfaceFile = "surface.ply";

bool legal_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.';
}

bool legal_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), legal_character);
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d vector_from_json(const Json& json) {
  const auto v = json.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

Json model_json(const ModelSource& model, const std::string& surface) {
  Json symmetries = {{"discrete", Json::array()}, {"continuous", Json::array()}};
  for (const Pose& pose : model.symmetry.discrete) {
    symmetries["discrete"].push_back(pose_to_json(pose));
  }
  for (const ContinuousSymmetry& symmetry : model.symmetry.continuous) {
    symmetries["continuous"].push_back(
        {{"axis", vector_json(symmetry.axis)}, {"point_m", vector_json(symmetry.point)}});
  }
  return {{"format", kFormat},
          {"version", kModelFileVersion},
          {"name", model.name},
          {"number", model.number},
          {"source", model.source},
          {"diameter_m", model.diameter},
          {"complete", model.complete},
          {"symmetries", symmetries},
          {"points", model.surface.size()},
          {"surface_bytes", surface.size()},
          {"surface_crc32", crc32(surface)}};
}

struct Description {
  ModelSource model;
  std::size_t points = 0;
  std::size_t surface_bytes = 0;
  std::uint32_t checksum = 0;
};

Result<Description> parse_description(const std::string& path, const Json& json) {
  if (json.value("format", "") != kFormat) {
    return Status(StatusCode::corrupt, path + " is not a model of this program");
  }
  const int version = json.at("version").get<int>();
  if (version != kModelFileVersion) {
    return Status(StatusCode::corrupt, path + " has format version " + std::to_string(version) +
                                           "; this program reads version " +
                                           std::to_string(kModelFileVersion) +
                                           ": build the model again");
  }
  Description result;
  result.model.name = json.at("name").get<std::string>();
  result.model.number = json.at("number").get<int>();
  result.model.source = json.at("source").get<std::string>();
  result.model.diameter = json.at("diameter_m").get<double>();
  result.model.complete = json.at("complete").get<bool>();
  for (const Json& pose : json.at("symmetries").at("discrete")) {
    result.model.symmetry.discrete.push_back(pose_from_json(pose));
  }
  for (const Json& symmetry : json.at("symmetries").at("continuous")) {
    result.model.symmetry.continuous.push_back(
        {vector_from_json(symmetry.at("axis")), vector_from_json(symmetry.at("point_m"))});
  }
  result.points = json.at("points").get<std::size_t>();
  result.surface_bytes = json.at("surface_bytes").get<std::size_t>();
  result.checksum = json.at("surface_crc32").get<std::uint32_t>();
  return result;
}

Result<Description> read_description(const std::string& path) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() { return parse_description(path, *json); });
}

Status read_surface(const std::string& path, Description& description) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  if (bytes->size() < description.surface_bytes) {
    return Status(StatusCode::corrupt, path + " is truncated: " + std::to_string(bytes->size()) +
                                           " of " + std::to_string(description.surface_bytes) +
                                           " bytes");
  }
  if (bytes->size() != description.surface_bytes || crc32(*bytes) != description.checksum) {
    return Status(StatusCode::corrupt,
                  path + " was altered: it does not match the checksum in " + kModelFile);
  }
  Result<TriangleMesh> mesh = parse_ply(*bytes, path);
  if (!mesh.ok()) return mesh.status();
  PointCloud& surface = description.model.surface;
  surface.points = std::move(mesh->vertices);
  surface.normals = std::move(mesh->normals);
  surface.colors = std::move(mesh->colors);
  if (surface.size() == description.points) return {};
  return Status(StatusCode::corrupt, path + " has " + std::to_string(surface.size()) +
                                         " points; model.json says " +
                                         std::to_string(description.points));
}

/// Fails when another model of the library has the number already.
Status check_number(const std::string& library, const ModelSource& model) {
  if (model.number < 1) {
    return invalid_argument("model number is " + std::to_string(model.number) +
                            "; it must be positive");
  }
  for (const std::string& name : list_models(library)) {
    if (name == model.name) continue;
    const Result<Description> other =
        read_description((fs::path(library) / name / kModelFile).string());
    if (other.ok() && other->model.number == model.number) {
      return invalid_argument("model number " + std::to_string(model.number) + " belongs to " +
                              name + " in " + library + "; numbers must differ");
    }
  }
  return {};
}

}  // namespace

std::string clean_model_name(const std::string& name) {
  std::string clean = name.substr(0, 100);
  for (char& c : clean) {
    if (!legal_character(c)) c = '_';
  }
  if (clean.empty() || clean[0] == '.') clean.insert(clean.begin(), '_');
  return clean.substr(0, 100);
}

Status save_model(const std::string& library, const ModelSource& model) {
  if (!legal_name(model.name)) {
    return invalid_argument("model name \"" + model.name +
                            "\" must be 1 to 100 letters, digits, '_', '-' and '.', and not begin "
                            "with '.'");
  }
  if (Status s = check_number(library, model); !s.ok()) return s;
  const fs::path target = fs::path(library) / model.name;
  const fs::path fresh = fs::path(library) / ("." + model.name + ".new");
  const fs::path old = fs::path(library) / ("." + model.name + ".old");
  std::error_code error;
  fs::remove_all(fresh, error);
  const std::string surface = ply_bytes(model.surface);
  Status status = write_file((fresh / kSurfaceFile).string(), surface);
  if (status.ok()) {
    status = write_file((fresh / kModelFile).string(), model_json(model, surface).dump(1) + "\n");
  }
  if (!status.ok()) return status;
  fs::remove_all(old, error);
  if (fs::exists(target)) fs::rename(target, old, error);
  if (!error) fs::rename(fresh, target, error);
  if (error) {
    return Status(StatusCode::unavailable,
                  target.string() + " cannot be written: " + error.message());
  }
  fs::remove_all(old, error);
  return {};
}

Result<ModelSource> load_model(const std::string& library, const std::string& name) {
  const fs::path folder = fs::path(library) / name;
  if (!legal_name(name) || !fs::exists(folder / kModelFile)) {
    return Status(StatusCode::not_found, "library " + library + " has no model \"" + name + "\"");
  }
  Result<Description> description = read_description((folder / kModelFile).string());
  if (!description.ok()) return description.status();
  if (description->model.name != name) {
    return Status(StatusCode::corrupt, (folder / kModelFile).string() + " names the model \"" +
                                           description->model.name + "\"; its folder must too");
  }
  if (Status s = read_surface((folder / kSurfaceFile).string(), *description); !s.ok()) return s;
  return std::move(description->model);
}

std::vector<std::string> list_models(const std::string& library) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(library, error)) {
    const std::string name = entry.path().filename().string();
    if (legal_name(name) && fs::exists(entry.path() / kModelFile, error)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<std::vector<ModelSource>> load_library(const std::string& library) {
  std::error_code error;
  if (!fs::is_directory(library, error)) {
    return Status(StatusCode::not_found, "library " + library + " is not there");
  }
  std::vector<ModelSource> models;
  for (const std::string& name : list_models(library)) {
    Result<ModelSource> model = load_model(library, name);
    if (!model.ok()) return model.status();
    models.push_back(std::move(*model));
  }
  if (models.empty()) {
    return invalid_argument("library " + library + " is empty; it must hold at least one model");
  }
  std::sort(models.begin(), models.end(),
            [](const ModelSource& a, const ModelSource& b) { return a.number < b.number; });
  for (std::size_t i = 1; i < models.size(); ++i) {
    if (models[i].number == models[i - 1].number) {
      return Status(StatusCode::corrupt, "library " + library + ": " + models[i - 1].name +
                                             " and " + models[i].name + " have the same number " +
                                             std::to_string(models[i].number));
    }
  }
  return models;
}

Status remove_model(const std::string& library, const std::string& name) {
  const fs::path folder = fs::path(library) / name;
  std::error_code error;
  if (!legal_name(name) || !fs::exists(folder / kModelFile, error)) {
    return Status(StatusCode::not_found, "library " + library + " has no model \"" + name + "\"");
  }
  fs::remove_all(folder, error);
  if (!error) return {};
  return Status(StatusCode::unavailable,
                folder.string() + " cannot be removed: " + error.message());
}

}  // namespace bpa::io
