// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/model_file.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/private/json_file.hpp"
#include "core/io/private/model_index_file.hpp"
#include "core/io/private/occupancy_file.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFormat = "bpa model";
constexpr const char* kModelFile = "model.json";
constexpr const char* kSurfaceFile = "surface.ply";
constexpr const char* kIndexFile = "index.bin";
constexpr const char* kOccupancyFile = "occupancy.bin";
constexpr const char* kOrigins[] = {"none", "declared", "found"};  // by SymmetryOrigin

bool legal_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.';
}

bool legal_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' &&
         std::all_of(name.begin(), name.end(), legal_character);
}

Json curve_json(const NoiseCurve& c) {
  return {{"floor", c.floor},
          {"edge_height", c.edge_height},
          {"edge_place_m", c.edge_place},
          {"edge_width_m", c.edge_width},
          {"angle_height", c.angle_height},
          {"angle_place", c.angle_place},
          {"angle_width", c.angle_width}};
}

NoiseCurve curve_from_json(const Json& json) {
  const auto get = [&json](const char* key) { return json.at(key).get<double>(); };
  return {get("floor"),        get("edge_height"), get("edge_place_m"), get("edge_width_m"),
          get("angle_height"), get("angle_place"), get("angle_width")};
}

Json file_json(const std::string& bytes) {
  return {{"bytes", bytes.size()}, {"crc32", crc32(bytes)}};
}

Json symmetry_json(const ModelSource& model) {
  Json symmetries = {{"origin", kOrigins[static_cast<int>(model.symmetry_origin)]},
                     {"discrete", Json::array()},
                     {"continuous", Json::array()}};
  for (const Pose& pose : model.symmetry.discrete) symmetries["discrete"].push_back(pose);
  for (const ContinuousSymmetry& symmetry : model.symmetry.continuous) {
    symmetries["continuous"].push_back({{"axis", symmetry.axis}, {"point_m", symmetry.point}});
  }
  return symmetries;
}

// `files` by name: their bytes.
Json model_json(const ModelSource& model, const std::map<std::string, std::string>& files) {
  Json records = Json::object();
  for (const auto& [name, bytes] : files) records[name] = file_json(bytes);
  return {{"format", kFormat},
          {"version", kModelFileVersion},
          {"name", model.name},
          {"number", model.number},
          {"source", model.source},
          {"diameter_m", model.diameter},
          {"complete", model.complete},
          {"symmetries", symmetry_json(model)},
          {"noise",
           {{"range_m", curve_json(model.noise.range)},
            {"normal_rad", curve_json(model.noise.normal)},
            {"depth_m", model.noise.depth},
            {"fitted", model.noise.fitted}}},
          {"warnings", model.warnings},
          {"points", model.surface.size()},
          {"files", records}};
}

struct FileRecord {
  std::size_t bytes = 0;
  std::uint32_t checksum = 0;
};

FileRecord record_from_json(const Json& json) {
  return {json.at("bytes").get<std::size_t>(), json.at("crc32").get<std::uint32_t>()};
}

struct Description {
  ModelSource model;
  std::size_t points = 0;
  FileRecord surface, index;
  std::optional<FileRecord> occupancy;
};

void parse_symmetry(const Json& json, ModelSource& model) {
  const auto origin = json.at("origin").get<std::string>();
  for (int k = 0; k < 3; ++k) {
    if (origin == kOrigins[k]) model.symmetry_origin = static_cast<SymmetryOrigin>(k);
  }
  model.symmetry.discrete = json.at("discrete").get<std::vector<Pose>>();
  for (const Json& symmetry : json.at("continuous")) {
    model.symmetry.continuous.push_back({symmetry.at("axis").get<Eigen::Vector3d>(),
                                         symmetry.at("point_m").get<Eigen::Vector3d>()});
  }
}

Result<Description> parse_description(const std::string& path, const Json& json) {
  if (json.value("format", "") != kFormat) {
    return Status(StatusCode::corrupt, path + " is not a model of this program");
  }
  const int version = json.at("version").get<int>();
  if (version != kModelFileVersion) {
    return Status(StatusCode::corrupt, path + " has format version " + std::to_string(version) +
                                           "; this program reads version " +
                                           std::to_string(kModelFileVersion) +
                                           ": make the model again (bpa model from-mesh, "
                                           "from-bop or from-scans)");
  }
  Description result;
  ModelSource& model = result.model;
  model.name = json.at("name").get<std::string>();
  model.number = json.at("number").get<int>();
  model.source = json.at("source").get<std::string>();
  model.diameter = json.at("diameter_m").get<double>();
  model.complete = json.at("complete").get<bool>();
  parse_symmetry(json.at("symmetries"), model);
  const Json& noise = json.at("noise");
  model.noise.range = curve_from_json(noise.at("range_m"));
  model.noise.normal = curve_from_json(noise.at("normal_rad"));
  model.noise.depth = noise.at("depth_m").get<double>();
  model.noise.fitted = noise.at("fitted").get<bool>();
  model.warnings = json.at("warnings").get<std::vector<std::string>>();
  result.points = json.at("points").get<std::size_t>();
  const Json& files = json.at("files");
  result.surface = record_from_json(files.at(kSurfaceFile));
  result.index = record_from_json(files.at(kIndexFile));
  if (files.contains(kOccupancyFile)) {
    result.occupancy = record_from_json(files.at(kOccupancyFile));
  }
  return result;
}

Result<Description> read_description(const std::string& path) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() { return parse_description(path, *json); });
}

/// The description of LIBRARY/NAME.
Result<Description> find_description(const std::string& library, const std::string& name) {
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
  return description;
}

/// A file's bytes if they are those that the description was written with.
Result<std::string> read_checked(const std::string& path, const FileRecord& record) {
  Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  if (bytes->size() < record.bytes) {
    return Status(StatusCode::corrupt, path + " is truncated: " + std::to_string(bytes->size()) +
                                           " of " + std::to_string(record.bytes) + " bytes");
  }
  if (bytes->size() != record.bytes || crc32(*bytes) != record.checksum) {
    return Status(StatusCode::corrupt,
                  path + " was altered: it does not match the checksum in " + kModelFile);
  }
  return bytes;
}

Status read_surface(const std::string& path, Description& description) {
  const Result<std::string> bytes = read_checked(path, description.surface);
  if (!bytes.ok()) return bytes.status();
  Result<TriangleMesh> mesh = parse_ply(*bytes, path);
  if (!mesh.ok()) return mesh.status();
  PointCloud& surface = description.model.surface;
  surface.points = std::move(mesh->vertices);
  surface.normals = std::move(mesh->normals);
  surface.colors = std::move(mesh->colors);
  if (surface.size() == description.points && surface.normals.size() == surface.size()) return {};
  return Status(StatusCode::corrupt, path + " has " + std::to_string(surface.size()) +
                                         " points; model.json says " +
                                         std::to_string(description.points) + " with normals");
}

Status read_index(const std::string& path, Description& description) {
  const Result<std::string> bytes = read_checked(path, description.index);
  if (!bytes.ok()) return bytes.status();
  Result<IndexFile> file = parse_index(*bytes, description.points, path);
  if (!file.ok()) return file.status();
  description.model.normal_variance = std::move(file->normal_variance);
  if (file->index == nullptr) return {};
  derive_index(description.model, *file->index);
  description.model.prepared = std::move(file->index);
  return {};
}

/// The bytes of the occupancy grid; empty when the model has none.
Result<std::string> read_occupancy(const std::string& path, const Description& description) {
  if (!description.occupancy) return std::string();
  return read_checked(path, *description.occupancy);
}

/// The files of a model but for its description, by name.
Result<std::map<std::string, std::string>> model_files(const ObjectModel& model) {
  std::map<std::string, std::string> files{
      {kSurfaceFile, ply_bytes(model.surface)},
      {kIndexFile, index_bytes(*model.index, model.normal_variance)}};
  if (model.occupancy == nullptr) return files;
  Result<std::string> occupancy = occupancy_bytes(*model.occupancy);
  if (!occupancy.ok()) return occupancy.status();
  files[kOccupancyFile] = std::move(*occupancy);
  return files;
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

Status save_model(const std::string& library, const ModelSource& source, int num_threads) {
  if (!legal_name(source.name)) {
    return invalid_argument("model name \"" + source.name +
                            "\" must be 1 to 100 letters, digits, '_', '-' and '.', and not begin "
                            "with '.'");
  }
  if (Status s = check_number(library, source); !s.ok()) return s;
  const auto made = make_object_model(source, num_threads);
  if (!made.ok()) return made.status();
  const ObjectModel& model = **made;
  const fs::path target = fs::path(library) / model.name;
  const fs::path fresh = fs::path(library) / ("." + model.name + ".new");
  const fs::path old = fs::path(library) / ("." + model.name + ".old");
  std::error_code error;
  fs::remove_all(fresh, error);
  const auto files = model_files(model);
  if (!files.ok()) return files.status();
  Status status =
      write_file((fresh / kModelFile).string(), model_json(model, *files).dump(1) + "\n");
  for (const auto& [name, bytes] : *files) {
    if (status.ok()) status = write_file((fresh / name).string(), bytes);
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
  Result<Description> description = find_description(library, name);
  if (!description.ok()) return description.status();
  const fs::path folder = fs::path(library) / name;
  if (Status s = read_surface((folder / kSurfaceFile).string(), *description); !s.ok()) return s;
  if (Status s = read_index((folder / kIndexFile).string(), *description); !s.ok()) return s;
  if (auto bytes = read_occupancy((folder / kOccupancyFile).string(), *description); !bytes.ok()) {
    return bytes.status();
  }
  return std::move(description->model);
}

Result<std::shared_ptr<const OccupancyGrid>> load_occupancy(const std::string& library,
                                                            const std::string& name) {
  const Result<Description> description = find_description(library, name);
  if (!description.ok()) return description.status();
  const std::string path = (fs::path(library) / name / kOccupancyFile).string();
  const Result<std::string> bytes = read_occupancy(path, *description);
  if (!bytes.ok()) return bytes.status();
  if (!description->occupancy) return std::shared_ptr<const OccupancyGrid>();
  Result<OccupancyGrid> grid = parse_occupancy(*bytes, path);
  if (!grid.ok()) return grid.status();
  return std::shared_ptr<const OccupancyGrid>(std::make_shared<OccupancyGrid>(std::move(*grid)));
}

Result<ModelSource> describe_model(const std::string& library, const std::string& name) {
  Result<Description> description = find_description(library, name);
  if (!description.ok()) return description.status();
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

Result<LibraryContents> read_library(const std::string& library, int num_threads) {
  std::error_code error;
  if (!fs::is_directory(library, error)) {
    return Status(StatusCode::not_found, "library " + library + " is not there");
  }
  const std::vector<std::string> names = list_models(library);
  std::vector<Result<ModelSource>> loaded(names.size(), Result<ModelSource>(ModelSource{}));
  parallel_for(static_cast<int>(names.size()), num_threads, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    loaded[k] = load_model(library, names[k]);
  });
  LibraryContents contents;
  std::map<int, std::string> owners;  // of numbers
  for (std::size_t k = 0; k < names.size(); ++k) {
    Status reason = loaded[k].status();
    if (reason.ok()) {
      const auto [owner, free] = owners.emplace(loaded[k]->number, names[k]);
      if (!free) {
        reason = Status(StatusCode::corrupt, owner->second + " and " + names[k] +
                                                 " have the same number " +
                                                 std::to_string(owner->first));
      }
    }
    if (reason.ok()) {
      contents.models.push_back(std::move(*loaded[k]));
    } else {
      contents.broken.push_back({names[k], std::move(reason)});
    }
  }
  std::sort(contents.models.begin(), contents.models.end(),
            [](const ModelSource& a, const ModelSource& b) { return a.number < b.number; });
  return contents;
}

Status explain_broken(const std::string& library, const std::vector<BrokenModel>& broken) {
  if (broken.empty()) return {};
  std::string text = "library " + library + ": " + std::to_string(broken.size()) +
                     (broken.size() == 1 ? " model" : " models") + " cannot be read";
  const char* separator = ": ";
  for (const BrokenModel& model : broken) {
    text += separator + model.name + " (" + model.reason.message + ")";
    separator = ", ";
  }
  return Status(StatusCode::corrupt, text);
}

Result<std::vector<ModelSource>> load_library(const std::string& library, int num_threads) {
  Result<LibraryContents> contents = read_library(library, num_threads);
  if (!contents.ok()) return contents.status();
  if (!contents->broken.empty()) return contents->broken.front().reason;
  if (contents->models.empty()) {
    return invalid_argument("library " + library + " is empty; it must hold at least one model");
  }
  return std::move(contents->models);
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
