// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/library_detector.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/draw/annotate.hpp"
#include "core/io/model_file.hpp"
#include "core/pipeline/score_layer_file.hpp"

namespace bpa::server {
namespace {

Status add_model(ModelSource source, int num_threads, ModelLibrary& library) {
  auto model = make_object_model(std::move(source), num_threads);
  if (!model.ok()) return model.status();
  return library.add(std::move(model).value());
}

}  // namespace

LibraryDetector::LibraryDetector(std::string folder, const DetectorOptions& options,
                                 int num_threads, ScoreLayers layers)
    : folder_(std::move(folder)),
      num_threads_(num_threads),
      layers_(std::move(layers)),
      detector_(std::make_shared<const Detector>(std::make_shared<const ModelLibrary>(), options,
                                                 layers_)) {}

Result<std::shared_ptr<LibraryDetector>> LibraryDetector::create(const std::string& folder,
                                                                 const DetectorOptions& options,
                                                                 int num_threads,
                                                                 const LogHook& hook) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    return Status(StatusCode::not_found, "library " + folder + ": there is no such folder");
  }
  Result<ScoreLayers> layers = library_score_layers(folder);
  if (!layers.ok()) return layers.status();
  std::shared_ptr<LibraryDetector> self(
      new LibraryDetector(folder, options, num_threads, std::move(*layers)));
  if (io::list_models(folder).empty()) {
    log(hook, LogLevel::warning,
        "library " + folder +
            " holds no model: every search fails until one is loaded; make some "
            "with `bpa model from-mesh` or `bpa model from-bop`");
    return self;
  }
  auto contents = io::read_library(folder, num_threads);
  if (!contents.ok()) return contents.status();
  ModelLibrary library;
  for (ModelSource& source : contents->models) {
    const std::string name = source.name;
    Status s = add_model(std::move(source), num_threads, library);
    if (!s.ok()) contents->broken.push_back({name, std::move(s)});
  }
  if (const Status s = io::explain_broken(folder, contents->broken); !s.ok()) {
    log(hook, LogLevel::error, s.message);
  }
  self->broken_ = std::move(contents->broken);
  log(hook, LogLevel::info,
      "library " + folder + ": " + std::to_string(library.size()) + " models");
  self->change(std::move(library));
  return self;
}

std::shared_ptr<const Detector> LibraryDetector::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return detector_;
}

int LibraryDetector::version() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return version_;
}

Models LibraryDetector::models() const { return current()->library().models(); }

std::vector<io::BrokenModel> LibraryDetector::broken() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return broken_;
}

Result<SceneInterpretations> LibraryDetector::detect(const Frame& frame,
                                                     const DetectRequest& request) const {
  return current()->detect(frame, request);
}

std::vector<std::uint8_t> LibraryDetector::annotate(const Frame& frame,
                                                    const Interpretation& interpretation) const {
  return draw::annotate(frame, interpretation, current()->library()).pixels;
}

void LibraryDetector::replace(ModelLibrary library, const DetectorOptions& options) {
  auto detector = std::make_shared<const Detector>(
      std::make_shared<const ModelLibrary>(std::move(library)), options, layers_);
  const std::lock_guard<std::mutex> lock(mutex_);
  detector_.swap(detector);
}

void LibraryDetector::change(ModelLibrary library) {
  replace(std::move(library), current()->options());
  const std::lock_guard<std::mutex> lock(mutex_);
  ++version_;
}

Status LibraryDetector::set_options(const DetectorOptions& options) {
  const std::lock_guard<std::mutex> lock(change_mutex_);
  replace(current()->library(), options);
  return {};
}

Result<std::shared_ptr<const ObjectModel>> LibraryDetector::load(const std::string& source,
                                                                 const std::string& name) {
  const std::lock_guard<std::mutex> lock(change_mutex_);
  // A model of our folder by name, or the path of a model's folder anywhere.
  const std::filesystem::path path(source);
  const bool is_path = source.find('/') != std::string::npos;
  auto read = is_path ? io::load_model(path.parent_path().string(), path.filename().string())
                      : io::load_model(folder_, source);
  if (!read.ok()) return read.status();
  if (!name.empty()) read->name = name;
  const std::string wanted = read->name;
  ModelLibrary library = current()->library();
  if (const auto old = library.find(wanted)) {
    read->number = old->number;
    if (Status s = library.remove(wanted); !s.ok()) return s;
  } else if (std::ranges::any_of(library.models(), [&](const auto& model) {
               return model->number == read->number;
             })) {
    read->number = library.next_number();
  }
  if (Status s = add_model(std::move(read).value(), num_threads_, library); !s.ok()) return s;
  auto model = library.find(wanted);
  change(std::move(library));
  if (!is_path) {  // it has been mended
    const std::lock_guard<std::mutex> mended(mutex_);
    std::erase_if(broken_, [&](const io::BrokenModel& other) { return other.name == source; });
  }
  return model;
}

Status LibraryDetector::unload(const std::string& name) {
  const std::lock_guard<std::mutex> lock(change_mutex_);
  ModelLibrary library = current()->library();
  if (Status s = library.remove(name); !s.ok()) return s;
  change(std::move(library));
  return {};
}

}  // namespace bpa::server
