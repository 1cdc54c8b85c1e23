// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/capture.hpp"
#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "server/options.hpp"
#include "server/services/service_set.hpp"
#include "server/sources/camera_publisher.hpp"
#include "server/sources/frame_source.hpp"
#include "server/worker.hpp"

namespace bpa::server {

/// The server's own camera: its frames go to the search and to camera topics, it can be recorded by
/// a service, and diagnostics say how it is.
class CameraSource : public FrameSource {
 public:
  /// `on_frame` and `idle` (whether no frame waits for the search) are called on the capture
  /// thread.
  static Result<std::unique_ptr<CameraSource>> create(const wire::Participant& participant,
                                                      const CaptureOptions& options,
                                                      std::function<void(IncomingFrame&&)> on_frame,
                                                      std::function<bool()> idle, LogHook log);

  std::vector<SourceReport> reports() const override;

 private:
  CameraSource() = default;

  // Destroyed from the last to the first: nothing calls into what is gone.
  std::unique_ptr<CameraPublisher> publisher_;
  std::unique_ptr<camera::Capture> capture_;
  std::optional<ServiceSet> services_;
};

}  // namespace bpa::server
