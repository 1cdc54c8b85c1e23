// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/model_file.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <map>

#include "core/base/concat.hpp"
#include "core/base/parallel.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/mesh_file.hpp"
#include "core/io/private/model_parts.hpp"

namespace bpa::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kModelFile = "model.json";
constexpr const char* kSurfaceFile = "surface.ply";
constexpr const char* kIndexFile = "index.bin";
constexpr const char* kOccupancyFile = "occupancy.bin";

bool legal_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.';
}

bool legal_name(const std::string& name) {
  return !name.empty() && name.size() <= 100 && name[0] != '.' &&
         std::ranges::all_of(name, legal_character);
}

/// The description of LIBRARY/NAME.
Result<ModelDescription> find_description(const std::string& library, const std::string& name) {
  const fs::path folder = fs::path(library) / name;
  std::error_code error;
  if (!legal_name(name) || !fs::exists(folder / kModelFile, error)) {
    if (error) return unavailable(folder.string(), " cannot be read: ", error.message());
    return not_found("library ", library, " has no model \"", name, "\"");
  }
  Result<ModelDescription> description = read_description((folder / kModelFile).string());
  if (!description.ok()) return description.status();
  if (description->model.name != name) {
    return corrupt((folder / kModelFile).string(), " names the model \"", description->model.name,
                   "\"; its folder must too");
  }
  return description;
}

std::string checksum(std::string_view bytes) {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016" PRIx64, xxh64(bytes));
  return digits.data();
}

/// A file's bytes if they are those that the description was written with.
Result<MappedFile> map_checked(const fs::path& folder, const char* name,
                               const ModelDescription& description) {
  const std::string path = (folder / name).string();
  const auto record = description.files.find(name);
  if (record == description.files.end()) return corrupt(path, " is not in ", kModelFile);
  Result<MappedFile> file = map_file(path);
  if (!file.ok()) return file.status();
  const auto& [size, xxh64] = record->second;
  if (file->bytes.size() < size) {
    return corrupt(path, " is truncated: ", file->bytes.size(), " of ", size, " bytes");
  }
  if (file->bytes.size() != size || checksum(file->bytes) != xxh64) {
    return corrupt(path, " was altered: it does not match the checksum in ", kModelFile);
  }
  return file;
}

Status read_surface(const fs::path& folder, ModelDescription& description) {
  const Result<MappedFile> file = map_checked(folder, kSurfaceFile, description);
  if (!file.ok()) return file.status();
  const std::string path = (folder / kSurfaceFile).string();
  Result<TriangleMesh> mesh = parse_ply(file->bytes, path);
  if (!mesh.ok()) return mesh.status();
  PointCloud& surface = description.model.surface;
  surface.points = std::move(mesh->vertices);
  surface.normals = std::move(mesh->normals);
  surface.colors = std::move(mesh->colors);
  if (surface.size() == description.points && surface.normals.size() == surface.size()) return {};
  return corrupt(path, " has ", surface.size(), " points; model.json says ", description.points,
                 " with normals");
}

Status read_index(const fs::path& folder, ModelDescription& description) {
  const Result<MappedFile> mapped = map_checked(folder, kIndexFile, description);
  if (!mapped.ok()) return mapped.status();
  Result<IndexFile> file = parse_index(*mapped, description.points, (folder / kIndexFile).string());
  if (!file.ok()) return file.status();
  description.model.normal_variance = std::move(file->normal_variance);
  if (file->index == nullptr) return {};
  derive_index(description.model, *file->index);
  description.model.prepared = std::move(file->index);
  return {};
}

/// The bytes of the occupancy grid; empty when the model has none.
Result<MappedFile> map_occupancy(const fs::path& folder, const ModelDescription& description) {
  if (description.files.count(kOccupancyFile) == 0) return MappedFile{};
  return map_checked(folder, kOccupancyFile, description);
}

/// The files of a model, by name.
Result<std::map<std::string, std::string>> model_files(const ObjectModel& model) {
  std::map<std::string, std::string> files{
      {kSurfaceFile, ply_bytes(model.surface)},
      {kIndexFile, index_bytes(*model.index, model.normal_variance)}};
  if (model.occupancy != nullptr) {
    Result<std::string> occupancy = occupancy_bytes(*model.occupancy);
    if (!occupancy.ok()) return occupancy.status();
    files[kOccupancyFile] = std::move(*occupancy);
  }
  ModelDescription description{model, model.surface.size(), {}};
  for (const auto& [name, bytes] : files) {
    description.files[name] = {bytes.size(), checksum(bytes)};
  }
  files[kModelFile] = description_text(description);
  return files;
}

/// Fails when another model of the library has the number already.
Status check_number(const std::string& library, const ModelSource& model) {
  if (model.number < 1) {
    return invalid_argument("model number is ", model.number, "; it must be positive");
  }
  for (const std::string& name : list_models(library)) {
    if (name == model.name) continue;
    const Result<ModelDescription> other =
        read_description((fs::path(library) / name / kModelFile).string());
    if (other.ok() && other->model.number == model.number) {
      return invalid_argument("model number ", model.number, " belongs to ", name, " in ", library,
                              "; numbers must differ");
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
    return invalid_argument("model name \"", source.name,
                            "\" must be 1 to 100 letters, digits, '_', '-' and '.', and not begin "
                            "with '.'");
  }
  if (Status s = check_number(library, source); !s.ok()) return s;
  const auto made = make_object_model(source, num_threads);
  if (!made.ok()) return made.status();
  const ObjectModel& model = **made;
  const fs::path target = fs::path(library) / model.name;
  const fs::path fresh = fs::path(library) / ("." + model.name + ".new");
  std::error_code error;
  fs::remove_all(fresh, error);
  const auto files = model_files(model);
  if (!files.ok()) return files.status();
  for (const auto& [name, bytes] : *files) {
    if (Status s = write_file((fresh / name).string(), bytes); !s.ok()) return s;
  }
  return replace_folder(fresh.string(), target.string());
}

Result<ModelSource> load_model(const std::string& library, const std::string& name) {
  Result<ModelDescription> description = find_description(library, name);
  if (!description.ok()) return description.status();
  const fs::path folder = fs::path(library) / name;
  if (Status s = read_surface(folder, *description); !s.ok()) return s;
  if (Status s = read_index(folder, *description); !s.ok()) return s;
  if (auto file = map_occupancy(folder, *description); !file.ok()) return file.status();
  return std::move(description->model);
}

Result<std::shared_ptr<const OccupancyGrid>> load_occupancy(const std::string& library,
                                                            const std::string& name) {
  const Result<ModelDescription> description = find_description(library, name);
  if (!description.ok()) return description.status();
  const fs::path folder = fs::path(library) / name;
  const Result<MappedFile> file = map_occupancy(folder, *description);
  if (!file.ok()) return file.status();
  if (file->bytes.empty()) return std::shared_ptr<const OccupancyGrid>();
  Result<OccupancyGrid> grid = parse_occupancy(file->bytes, (folder / kOccupancyFile).string());
  if (!grid.ok()) return grid.status();
  return std::shared_ptr<const OccupancyGrid>(std::make_shared<OccupancyGrid>(std::move(*grid)));
}

Result<ModelSource> describe_model(const std::string& library, const std::string& name) {
  Result<ModelDescription> description = find_description(library, name);
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
  if (!fs::is_directory(library, error)) return not_found("library ", library, " is not there");
  const std::vector<std::string> names = list_models(library);
  std::vector<Result<ModelSource>> loaded(names.size(), Result<ModelSource>(ModelSource{}));
  parallel_for(names.size(), num_threads,
               [&](std::size_t k) { loaded[k] = load_model(library, names[k]); });
  LibraryContents contents;
  std::map<int, std::string> owners;  // of numbers
  for (std::size_t k = 0; k < names.size(); ++k) {
    Status reason = loaded[k].status();
    if (reason.ok()) {
      const auto [owner, free] = owners.emplace(loaded[k]->number, names[k]);
      if (!free) {
        reason = corrupt(owner->second, " and ", names[k], " have the same number ", owner->first);
      }
    }
    if (reason.ok()) {
      contents.models.push_back(std::move(*loaded[k]));
    } else {
      contents.broken.push_back({names[k], std::move(reason)});
    }
  }
  std::ranges::sort(contents.models, {}, &ModelSource::number);
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
  return corrupt(text);
}

Result<std::vector<ModelSource>> load_library(const std::string& library, int num_threads) {
  Result<LibraryContents> contents = read_library(library, num_threads);
  if (!contents.ok()) return contents.status();
  if (!contents->broken.empty()) return contents->broken.front().reason;
  if (contents->models.empty()) {
    return invalid_argument("library ", library, " is empty; it must hold at least one model");
  }
  return std::move(contents->models);
}

Status remove_model(const std::string& library, const std::string& name) {
  const fs::path folder = fs::path(library) / name;
  std::error_code error;
  if (!legal_name(name) || !fs::exists(folder / kModelFile, error)) {
    return not_found("library ", library, " has no model \"", name, "\"");
  }
  fs::remove_all(folder, error);
  if (!error) return {};
  return unavailable(folder.string(), " cannot be removed: ", error.message());
}

}  // namespace bpa::io
