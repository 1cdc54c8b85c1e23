// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/base/status.hpp"
#include "core/cloud/frame.hpp"
#include "server/options.hpp"
#include "server/search_queue.hpp"
#include "server/web/http.hpp"

// What a viewer asks to be searched, as the job that a request over DDS makes.

namespace bpa::server::web {

/// {"models": [NAME...], "top_k": N, "budget_ms": MS, "seed": N, "region": [x, y, width, height],
/// "polygon": [[x, y]...]}, all optional. `frame` is searched where it is not null, else the
/// camera's next frame, whole. Fails with invalid_argument.
Result<DetectJob> search_job(const std::string& json, const std::shared_ptr<const Frame>& frame,
                             const DetectionOptions& options);

/// The frame of an upload: the query has `kind` "png" or "pcd". A PNG's body is the depth image, of
/// `depth_bytes`, and the colour image after it, if any; `fx fy cx cy` are its camera,
/// `depth_scale_mm` millimetres of a unit of depth (1 without). Fails as the readers of files do,
/// and as doctor::make_searchable().
Result<Frame> uploaded_frame(const Request& request, double max_range_m);

}  // namespace bpa::server::web
