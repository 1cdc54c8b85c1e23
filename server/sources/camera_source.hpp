// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"
#include "server/options.hpp"
#include "server/sources/frame_source.hpp"

namespace bpa::server {

/// The server's own camera: its frames go to the search and to camera topics, it can be recorded by
/// a service, and diagnostics say how it is. `on_frame` and `idle` (whether no frame waits for the
/// search) are called on the capture thread.
Result<std::unique_ptr<FrameSource>> open_camera_source(const wire::Participant& participant,
                                                        const CaptureOptions& options,
                                                        OnFrame on_frame,
                                                        std::function<bool()> idle, LogHook log);

}  // namespace bpa::server
