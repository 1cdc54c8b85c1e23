// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/io/model_file.hpp"
#include "core/pipeline/detector.hpp"
#include "server/recognition.hpp"

namespace bpa::server {

/// The detector with a library from disk whose models may come and go while it serves. A search
/// that runs keeps the library it began with.
class LibraryDetector : public Recognition {
 public:
  /// Reads the library. A folder without models is no failure (searches fail until one is loaded),
  /// and a broken model is left out and told to `log`; a folder that is not there is a failure.
  static Result<std::shared_ptr<LibraryDetector>> create(const std::string& folder,
                                                         const DetectorOptions& options,
                                                         int num_threads, const LogHook& log);

  Result<SceneInterpretations> detect(const Frame& frame,
                                      const DetectRequest& request) const override;
  std::vector<std::uint8_t> annotate(const Frame& frame,
                                     const Interpretation& interpretation) const override;
  std::string library() const override { return folder_; }
  int version() const override;
  Models models() const override;
  std::vector<io::BrokenModel> broken() const override;
  Result<std::shared_ptr<const ObjectModel>> load(const std::string& source,
                                                  const std::string& name) override;
  Status unload(const std::string& name) override;
  Status set_options(const DetectorOptions& options) override;

 private:
  LibraryDetector(std::string folder, const DetectorOptions& options, int num_threads,
                  ScoreLayers layers);
  std::shared_ptr<const Detector> current() const;
  void replace(ModelLibrary library, const DetectorOptions& options);
  void change(ModelLibrary library);  // with the same options, and counts it

  const std::string folder_;
  const int num_threads_;
  const ScoreLayers layers_;  ///< The library's own, or the built-in ones.
  std::mutex change_mutex_;   ///< Held while a change is being made.
  mutable std::mutex mutex_;  ///< Guards what follows, never held for long.
  std::shared_ptr<const Detector> detector_;
  std::vector<io::BrokenModel> broken_;  ///< Of the folder.
  int version_ = 1;
};

}  // namespace bpa::server
