// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "core/draw/annotate.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "core/pipeline/detector.hpp"
#include "server/group/front.hpp"
#include "server/library_tracker.hpp"
#include "server/recognition.hpp"

namespace bpa::server {
namespace {

Status add_model(ModelSource source, int num_threads, ModelLibrary& library) {
  auto model = make_object_model(std::move(source), num_threads);
  if (!model.ok()) return model.status();
  return library.add(std::move(model).value());
}

Status check_name(const std::string& field, const std::string& name) {
  if (io::clean_model_name(name) == name) return {};
  return invalid_argument(field +
                          " must have 1 to 100 letters, digits, '_', '-' and '.', and not "
                          "begin with '.'");
}

/// A search that runs keeps the library it began with.
class LibraryDetector : public Recognition {
 public:
  LibraryDetector(const DetectionOptions& detection, const DetectorOptions& options,
                  score::ScoreLayers layers)
      : folder_(detection.library),
        model_folder_(detection.model_folder),
        max_models_(detection.max_models),
        num_threads_(detection.threads),
        layers_(std::move(layers)),
        current_{make_detector({}, options), {}, nullptr, nullptr} {}

  std::string library() const override { return folder_; }

  int version() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return version_;
  }

  Models models() const override { return current()->library().models(); }

  std::vector<io::BrokenModel> broken() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return broken_;
  }

  Result<SceneInterpretations> detect(const Frame& frame,
                                      const DetectRequest& request) const override {
    return detect_beside(frame, request, 0);
  }

  Result<SceneInterpretations> detect_beside(const Frame& frame, const DetectRequest& request,
                                             std::size_t waiting) const override {
    const Current now = this->now();
    return now.detector->detect(frame, request, nullptr, now.search_for(frame, request, waiting));
  }

  std::size_t searches_at_once() const override {
    const auto front = now().front;
    return front ? std::max<std::size_t>(1, front->ready_workers()) : 1;
  }

  void join_group(const wire::Participant& participant, const GroupOptions& options,
                  LogHook log) override {
    const std::lock_guard<std::mutex> change_lock(change_mutex_);
    Current next = now();
    next.front = or_throw(group::Front::create(participant, options.name, std::move(log)));
    or_throw(put(std::move(next)));
  }

  void leave_group() override {
    const std::lock_guard<std::mutex> change_lock(change_mutex_);
    Current next = now();
    if (!next.front) return;
    next.front = nullptr;
    (void)put(std::move(next));
  }

  std::vector<WorkerState> workers() const override {
    const auto front = now().front;
    return front ? front->workers() : std::vector<WorkerState>();
  }

  Result<ViewsResult> detect_views(std::span<const View> views,
                                   const DetectRequest& request) const override {
    const Current now = this->now();
    return bpa::detect_views(*now.detector, views, request,
                             [&](const Frame& frame, const DetectRequest& of_view) {
                               return now.search_for(frame, of_view, 0);
                             });
  }

  std::unique_ptr<ObjectTracker> make_tracker(const track::TrackerOptions& options) const override {
    return make_library_tracker([this] { return current(); }, layers_, options);
  }

  std::vector<std::uint8_t> annotate(const Frame& frame,
                                     const Interpretation& interpretation) const override {
    return draw::annotate(frame, interpretation, current()->library()).pixels;
  }

  std::vector<ScoreTerm> score_terms(const Placement& placement) const override {
    score::ScoreValues values;
    values.fill(score::kNotKnown);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto found = std::ranges::find(placement.components, score::kScoreComponents[i].name,
                                           &ScoreComponent::name);
      if (found != placement.components.end()) values[i] = found->value;
    }
    const score::ScoreLayer& layer = layers_.last_for(values);
    std::vector<ScoreTerm> terms = {{"bias", "log odds", "Of the score layer.", 0, layer.bias}};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const score::ComponentType& type = score::kScoreComponents[i];
      if (std::isnan(values[i])) continue;
      terms.push_back({std::string(type.name), std::string(type.unit), std::string(type.meaning),
                       values[i], type.learned ? layer.components[i].at(values[i]) : 0});
    }
    return terms;
  }

  Status set_options(const DetectorOptions& options) override {
    const std::lock_guard<std::mutex> lock(change_mutex_);
    Current next = now();
    next.detector = make_detector(next.detector->library(), options);
    return put(std::move(next));
  }

  Result<std::shared_ptr<const ObjectModel>> load(const std::string& source,
                                                  const std::string& name) override {
    if (Status s = name.empty() ? Status() : check_name("name", name); !s.ok()) return s;
    const std::lock_guard<std::mutex> lock(change_mutex_);
    const bool is_path = source.find('/') != std::string::npos;
    auto folder = is_path ? folder_of_path(source) : folder_of_name(source);
    if (!folder.ok()) return folder.status();
    auto read = io::load_model(folder->parent_path().string(), folder->filename().string());
    if (!read.ok()) return read.status();
    if (!name.empty()) read->name = name;
    const std::string wanted = read->name;
    ModelLibrary library = current()->library();
    if (const auto old = library.find(wanted)) {
      read->number = old->number;
      if (Status s = library.remove(wanted); !s.ok()) return s;
    } else if (library.size() >= max_models_) {
      return Status(StatusCode::busy, concat(library.size(),
                                             " models are loaded, as many as may "
                                             "(detection.max_models); unload one"));
    } else if (std::ranges::any_of(library.models(), [&](const auto& model) {
                 return model->number == read->number;
               })) {
      read->number = library.next_number();
    }
    if (Status s = add_model(std::move(read).value(), num_threads_, library); !s.ok()) return s;
    auto model = library.find(wanted);
    Current next = now();
    next.folders[wanted] = folder->string();
    if (Status s = change(std::move(library), std::move(next)); !s.ok()) return s;
    if (!is_path) {  // it has been mended
      const std::lock_guard<std::mutex> mended(mutex_);
      std::erase_if(broken_, [&](const io::BrokenModel& other) { return other.name == source; });
    }
    return model;
  }

  Status unload(const std::string& name) override {
    const std::lock_guard<std::mutex> lock(change_mutex_);
    ModelLibrary library = current()->library();
    if (Status s = library.remove(name); !s.ok()) return s;
    return change(std::move(library), now());
  }

  /// With what the folder holds.
  void fill(ModelLibrary library, std::vector<io::BrokenModel> broken) {
    broken_ = std::move(broken);
    Current next = now();
    for (const auto& model : library.models()) {
      next.folders[model->name] = folder_ + "/" + model->name;
    }
    (void)change(std::move(library), std::move(next));  // no front to refuse it
  }

 private:
  /// What searches use.
  struct Current {
    std::shared_ptr<const Detector> detector;
    std::map<std::string, std::string> folders;          ///< Of models, by name.
    std::shared_ptr<group::Front> front;                 ///< Null for a single server.
    std::shared_ptr<const group::SharedLibrary> shared;  ///< With a front: the detector's library.

    /// On the group's workers; empty where there are none.
    RemoteSearch search_for(const Frame& frame, const DetectRequest& request,
                            std::size_t waiting) const {
      if (!front || front->ready_workers() == 0) return {};
      return front->search_for(shared, *detector, frame, request, waiting);
    }
  };

  /// Of a model of our folder.
  Result<std::filesystem::path> folder_of_name(const std::string& name) const {
    if (Status s = check_name("source", name); !s.ok()) return s;
    return std::filesystem::path(folder_) / name;
  }

  /// Of a model elsewhere: its folder, or the description in it.
  Result<std::filesystem::path> folder_of_path(const std::string& source) const {
    if (model_folder_.empty()) {
      return Status(StatusCode::unsupported,
                    "source is a path; without detection.model_folder it must be the name of a "
                    "model in the library");
    }
    const Result<std::string> below = io::path_below(model_folder_, source);
    if (!below.ok()) return below.status();
    std::filesystem::path path(*below);
    if (path.filename() == "model.json") path = path.parent_path();
    if (Status s = check_name("the folder's name", path.filename()); !s.ok()) return s;
    return path;
  }

  Current now() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return current_;
  }
  std::shared_ptr<const Detector> current() const { return now().detector; }

  std::shared_ptr<const Detector> make_detector(ModelLibrary library,
                                                const DetectorOptions& options) const {
    return std::make_shared<const Detector>(
        std::make_shared<const ModelLibrary>(std::move(library)), options, layers_);
  }

  /// In force for searches that begin from now on; offered to the group's workers before.
  Status put(Current next) {
    if (next.front) {
      auto shared = group::share_library(next.detector->library(), layers_, next.folders);
      if (!shared.ok()) return shared.status();
      next.shared = *std::move(shared);
      next.front->set_library(next.shared);
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      std::swap(current_, next);
    }
    return {};  // what was before ends here, with the mutex free
  }

  /// With the same options, and counts it.
  Status change(ModelLibrary library, Current next) {
    next.detector = make_detector(std::move(library), next.detector->options());
    if (Status s = put(std::move(next)); !s.ok()) return s;
    const std::lock_guard<std::mutex> lock(mutex_);
    ++version_;
    return {};
  }

  const std::string folder_;
  const std::string model_folder_;
  const int max_models_;
  const int num_threads_;
  const score::ScoreLayers layers_;  ///< The library's own, or the built-in ones.
  std::mutex change_mutex_;          ///< Held while a change is being made.
  mutable std::mutex mutex_;         ///< Guards what follows, never held for long.
  Current current_;
  std::vector<io::BrokenModel> broken_;  ///< Of the folder.
  int version_ = 1;
};

}  // namespace

Result<std::shared_ptr<Recognition>> open_library(const DetectionOptions& detection,
                                                  const DetectorOptions& options,
                                                  const LogHook& hook) {
  const std::string& folder = detection.library;
  if (!io::is_folder(folder)) {
    return Status(StatusCode::not_found, "library " + folder + ": there is no such folder");
  }
  std::error_code error;
  const std::filesystem::directory_iterator entries(folder, error);
  if (error) return unavailable("library ", folder, " cannot be read: ", error.message());
  Result<score::ScoreLayers> layers = library_score_layers(folder);
  if (!layers.ok()) return layers.status();
  const auto self =
      std::make_shared<LibraryDetector>(detection, options, std::move(layers).value());
  if (io::list_models(folder).empty()) {
    log(hook, LogLevel::warning,
        "library " + folder +
            " holds no model: every search fails until one is loaded; make some "
            "with `bpa model from-mesh` or `bpa model from-bop`");
    return std::shared_ptr<Recognition>(self);
  }
  auto contents = io::read_library(folder, detection.threads);
  if (!contents.ok()) return contents.status();
  ModelLibrary library;
  for (ModelSource& source : contents->models) {
    const std::string name = source.name;
    Status s = add_model(std::move(source), detection.threads, library);
    if (!s.ok()) contents->broken.push_back({name, std::move(s)});
  }
  if (const Status s = io::explain_broken(folder, contents->broken); !s.ok()) {
    log(hook, LogLevel::error, s.message);
  }
  log(hook, LogLevel::info,
      "library " + folder + ": " + std::to_string(library.size()) + " models");
  self->fill(std::move(library), std::move(contents->broken));
  return std::shared_ptr<Recognition>(self);
}

}  // namespace bpa::server
