// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/io/model_file.hpp"
#include "core/pipeline/detector.hpp"
#include "core/result/interpretation.hpp"
#include "server/convert/results.hpp"

namespace bpa::server {

/// What the server serves: the detector with its library, or a stand-in. Each function may be
/// called from any thread.
struct Recognition {
  /// Must be set.
  std::function<Result<SceneInterpretations>(const Frame&, const DetectRequest&)> detect;
  /// An rgb image as large as the frame; empty: no annotated images.
  std::function<Result<std::vector<std::uint8_t>>(const Frame&, const Interpretation&)> annotate;
  /// The models now, by number; empty: none.
  std::function<Models()> models;
  /// The models of the library's folder that cannot be read; empty: none.
  std::function<std::vector<io::BrokenModel>()> broken;
  /// Takes a model up, by its name in the library's folder or by file; empty: not supported.
  std::function<Result<std::shared_ptr<const ObjectModel>>(const std::string& source,
                                                           const std::string& name)>
      load;
  std::function<Status(const std::string& name)> unload;  ///< Empty: not supported.
  /// Searches that begin from now on have these settings; empty: not supported.
  std::function<Status(const DetectorOptions&)> set_options;
  std::function<int()> version;  ///< Grows with every load and unload; empty: always 1.
  std::string library;           ///< Where it lies, for people.
};

}  // namespace bpa::server
