// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "core/io/model_file.hpp"
#include "core/pipeline/detector.hpp"
#include "core/pipeline/views.hpp"
#include "core/result/interpretation.hpp"
#include "idl/wire/participant.hpp"
#include "server/convert/results.hpp"
#include "server/object_tracker.hpp"
#include "server/options.hpp"

namespace bpa::server {

/// A worker of the server's group, as its front sees it.
struct WorkerState {
  std::string name;
  bool ready = false;     ///< It has the front's library and program version.
  std::string problem;    ///< Why it is not.
  double ms_a_model = 0;  ///< Measured; 0: not yet.
  int searches = 0;       ///< That it takes part in now.
};

/// What one component adds to a placement's score.
struct ScoreTerm {
  std::string name, unit, meaning;
  double value = 0;     ///< Of the component.
  double log_odds = 0;  ///< That it adds; the score is their sum.
};

/// What the server serves: the detector with its library (open_library()), or the tests'
/// stub. Every function may be called from any thread.
class Recognition {
 public:
  virtual ~Recognition() = default;

  /// Finds the models that the request names in a frame.
  virtual Result<SceneInterpretations> detect(const Frame& frame,
                                              const DetectRequest& request) const = 0;
  /// The same, while `waiting` more frames wait: where several hosts search, they share in that.
  virtual Result<SceneInterpretations> detect_beside(const Frame& frame,
                                                     const DetectRequest& request,
                                                     std::size_t waiting) const {
    (void)waiting;
    return detect(frame, request);
  }
  /// How many frames can be searched at once without taking time from one another; 1 or more.
  virtual std::size_t searches_at_once() const { return 1; }

  /// Lets the group's workers search from now on, until leave_group(). The participant stays until
  /// then. Throws a Failure.
  virtual void join_group(const wire::Participant&, const GroupOptions&, LogHook) {}
  virtual void leave_group() {}
  /// The workers of the group; empty for a single server.
  virtual std::vector<WorkerState> workers() const { return {}; }

  /// The same in several views of one scene, in the fixed frame; `unsupported` where only frames
  /// are searched.
  virtual Result<ViewsResult> detect_views(std::span<const View>, const DetectRequest&) const {
    return Status(StatusCode::unsupported, "several views of one scene are not searched here");
  }

  /// The frame's image with the placements drawn on it: row-major rgb, 3 bytes a pixel.
  virtual std::vector<std::uint8_t> annotate(const Frame& frame,
                                             const Interpretation& interpretation) const = 0;

  /// What the score of a placement is made of, the bias of the score layer first. Empty where that
  /// is not known.
  virtual std::vector<ScoreTerm> score_terms(const Placement&) const { return {}; }

  /// Follows objects of these models; the recognition outlives it.
  virtual std::unique_ptr<ObjectTracker> make_tracker(
      const track::TrackerOptions& options) const = 0;

  /// Where the library lies, for people.
  virtual std::string library() const = 0;
  /// Grows with every load and unload; starts at 1.
  virtual int version() const = 0;
  /// The models that searches use now, by number.
  virtual Models models() const = 0;
  /// The models of the library's folder that cannot be read.
  virtual std::vector<io::BrokenModel> broken() const = 0;

  /// Loads a model as `name` (empty: its own), replacing one of that name. `source`: a name in the
  /// library's folder, or the path of a model's folder or its model.json. `unsupported` where the
  /// library is fixed, as for the next two, and for a path where none is allowed.
  virtual Result<std::shared_ptr<const ObjectModel>> load(const std::string& source,
                                                          const std::string& name) = 0;
  /// Forgets a model; `not_found` without one of that name.
  virtual Status unload(const std::string& name) = 0;
  /// Searches that begin from now on have these settings.
  virtual Status set_options(const DetectorOptions& options) = 0;
};

/// The detector with a library from disk, whose models may be loaded and unloaded at run time.
/// Linked into bpa-server alone. A missing folder is a failure, and one that cannot be read; a
/// folder without models is none (searches fail until one is loaded). A broken model is left out
/// and reported to `log`.
Result<std::shared_ptr<Recognition>> open_library(const DetectionOptions& detection,
                                                  const DetectorOptions& options,
                                                  const LogHook& log);

}  // namespace bpa::server
