// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/library.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "server/convert/results.hpp"

namespace bpa::server::group {
namespace {

namespace fs = std::filesystem;
namespace msgs = wire::bpa_msgs;

constexpr const char* kDescription = "model.json";
constexpr std::size_t kMaxModels = 10000;
constexpr std::uint64_t kMaxFile = 1073741824;  // bytes

std::string digest_of(std::string_view bytes) {
  return format("%016llx", static_cast<unsigned long long>(io::xxh64(bytes)));
}

Result<std::string> digest_of_model(const std::string& folder) {
  const Result<std::string> bytes = io::read_file(folder + "/" + kDescription);
  if (!bytes.ok()) return bytes.status();
  return digest_of(*bytes);
}

/// The files of a model's folder, model.json first.
std::vector<std::string> files_of(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.is_regular_file(error)) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  const auto first = std::ranges::find(names, kDescription);
  if (first != names.end()) std::rotate(names.begin(), first, first + 1);
  return names;
}

bool is_name(const std::string& text) { return io::clean_model_name(text) == text; }

/// Names come from the wire and become paths.
Status check(const msgs::GroupModel& model) {
  const bool is_digest = model.digest.size() == 16 &&
                         model.digest.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (is_digest && is_name(model.name) && is_name(model.stored_name) && model.number > 0) return {};
  return invalid_argument("the front offers a model \"", model.name, "\" (\"", model.stored_name,
                          "\", number ", model.number, ", digest \"", model.digest,
                          "\"), which is no legal one");
}

Result<std::string> fetch_file(const msgs::GroupModel& model, const std::string& file,
                               const ModelCache::Fetch& fetch) {
  std::string bytes;
  while (true) {
    const auto part = fetch({.model = model.name,
                             .digest = model.digest,
                             .file = file,
                             .offset = bytes.size(),
                             .size = kMaxFilePart});
    if (!part.ok()) return part.status();
    bytes.append(part->bytes.begin(), part->bytes.end());
    if (bytes.size() == part->file_bytes) return bytes;
    const bool fits = part->file_bytes <= kMaxFile && bytes.size() < part->file_bytes;
    if (part->bytes.empty() || !fits) {
      return corrupt("model ", model.name, ": ", file, " came with ", bytes.size(), " bytes of ",
                     part->file_bytes);
    }
  }
}

/// Into `folder`, which is there.
Status fetch_model(const msgs::GroupModel& model, const ModelCache::Fetch& fetch,
                   const std::string& folder) {
  const auto listed =
      fetch({.model = model.name, .digest = model.digest, .file = {}, .offset = 0, .size = 0});
  if (!listed.ok()) return listed.status();
  for (const std::string& file : listed->files) {
    if (!is_name(file)) return corrupt("model ", model.name, " has a file named \"", file, "\"");
    const Result<std::string> bytes = fetch_file(model, file, fetch);
    if (!bytes.ok()) return bytes.status();
    Status written = io::write_file(folder + "/" + file, *bytes, io::Sync::later);
    if (!written.ok()) return written;
  }
  const Result<std::string> digest = digest_of_model(folder);
  if (!digest.ok()) return digest.status();
  if (*digest == model.digest) return {};
  return corrupt("model ", model.name, " came in version ", *digest, ", not ", model.digest);
}

}  // namespace

std::shared_ptr<const ObjectModel> SharedLibrary::find(int number) const {
  const auto found =
      std::ranges::find(models.models(), number, [](const auto& model) { return model->number; });
  return found == models.models().end() ? nullptr : *found;
}

Result<std::shared_ptr<const SharedLibrary>> share_library(
    ModelLibrary models, score::ScoreLayers layers, std::map<std::string, std::string> folders) {
  auto shared = std::make_shared<SharedLibrary>();
  msgs::GroupLibrary& offer = shared->offer;
  offer.score_layers = score::to_json(layers);
  std::string all = offer.score_layers;
  for (const auto& model : models.models()) {
    const std::string& folder = folders[model->name];
    Result<std::string> digest = digest_of_model(folder);
    if (!digest.ok()) return digest.status();
    all += concat('\n', model->name, ' ', model->number, ' ', *digest);
    offer.models.push_back({.name = model->name,
                            .number = model->number,
                            .stored_name = fs::path(folder).filename().string(),
                            .digest = *std::move(digest)});
  }
  offer.digest = digest_of(all);
  shared->models = std::move(models);
  shared->layers = std::move(layers);
  shared->folders = std::move(folders);
  return std::shared_ptr<const SharedLibrary>(std::move(shared));
}

msgs::GetModelFile_Response read_model_file(const SharedLibrary& library,
                                            const msgs::GetModelFile_Request& request) {
  msgs::GetModelFile_Response response;
  const auto refuse = [&](const Status& status) {
    response.status = server::to_message(status);
    return response;
  };
  const auto model =
      std::ranges::find(library.offer.models, request.model, &msgs::GroupModel::name);
  if (model == library.offer.models.end() || model->digest != request.digest) {
    return refuse(
        not_found("the library has no model \"", request.model, "\" of version ", request.digest));
  }
  const std::string& folder = library.folders.at(request.model);
  const Result<std::string> digest = digest_of_model(folder);
  if (!digest.ok() || *digest != request.digest) {
    return refuse(corrupt("model ", request.model,
                          " was changed on disk after it was loaded: ", "load it again"));
  }
  response.files = files_of(folder);
  if (!request.file.empty()) {
    if (std::ranges::count(response.files, request.file) == 0) {
      return refuse(not_found("model ", request.model, " has no file ", request.file));
    }
    const Result<io::MappedFile> file = io::map_file(folder + "/" + request.file);
    if (!file.ok()) return refuse(file.status());
    response.file_bytes = file->bytes.size();
    const std::string_view part =
        file->bytes.substr(std::min<std::uint64_t>(request.offset, file->bytes.size()),
                           std::min(request.size, kMaxFilePart));
    response.bytes.assign(part.begin(), part.end());
  }
  response.success = true;
  return response;
}

Result<std::string> ModelCache::folder_of(const msgs::GroupModel& model, const Fetch& fetch) const {
  if (Status status = check(model); !status.ok()) return status;
  const fs::path version = fs::path(folder_) / model.digest;
  const std::string folder = (version / model.stored_name).string();
  if (const auto digest = digest_of_model(folder); digest.ok() && *digest == model.digest) {
    return folder;
  }
  // Beside, then renamed: another worker never sees a part of it.
  const std::string beside = concat(version.string(), ".", getpid(), ".part");
  const std::string unfinished = beside + "/" + model.stored_name;
  std::error_code ignored;
  fs::remove_all(beside, ignored);
  Status status = io::make_folder(unfinished);
  if (status.ok()) status = fetch_model(model, fetch, unfinished);
  if (status.ok()) {
    fs::remove_all(version, ignored);
    std::error_code error;
    fs::rename(beside, version, error);
    // Another worker may have been faster.
    if (error && !io::is_file(folder + "/" + kDescription)) {
      status = unavailable(version.string(), " cannot be written: ", error.message());
    }
  }
  fs::remove_all(beside, ignored);
  if (!status.ok()) return status;
  return folder;
}

Result<std::shared_ptr<const SharedLibrary>> load_library(const msgs::GroupLibrary& offer,
                                                          const SharedLibrary* before,
                                                          const ModelCache& cache,
                                                          const ModelCache::Fetch& fetch,
                                                          int num_threads) {
  if (offer.models.size() > kMaxModels) {
    return invalid_argument("the front offers ", offer.models.size(), " models; a worker takes ",
                            kMaxModels, " at most");
  }
  auto shared = std::make_shared<SharedLibrary>();
  shared->offer = offer;
  Result<score::ScoreLayers> layers =
      score::score_layers_from_json(offer.score_layers, "the front's score layers");
  if (!layers.ok()) return layers.status();
  shared->layers = *std::move(layers);
  for (const msgs::GroupModel& wanted : offer.models) {
    std::shared_ptr<const ObjectModel> model;
    const auto same = [&](const msgs::GroupModel& other) {
      return other.name == wanted.name && other.number == wanted.number &&
             other.digest == wanted.digest;
    };
    if (before != nullptr && std::ranges::any_of(before->offer.models, same)) {
      model = before->find(wanted.number);
      shared->folders[wanted.name] = before->folders.at(wanted.name);
    }
    if (!model) {
      const Result<std::string> folder = cache.folder_of(wanted, fetch);
      if (!folder.ok()) return folder.status();
      Result<ModelSource> source =
          io::load_model(fs::path(*folder).parent_path().string(), wanted.stored_name);
      if (!source.ok()) return source.status();
      source->name = wanted.name;
      source->number = wanted.number;
      auto made = make_object_model(*std::move(source), num_threads);
      if (!made.ok()) return made.status();
      model = *std::move(made);
      shared->folders[wanted.name] = *folder;
    }
    if (Status status = shared->models.add(std::move(model)); !status.ok()) return status;
  }
  return std::shared_ptr<const SharedLibrary>(std::move(shared));
}

}  // namespace bpa::server::group
