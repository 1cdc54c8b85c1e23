// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/doctor/finding.hpp"
#include "core/model/object_model.hpp"
#include "core/result/placement.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "idl/wire/msg/diagnostic_msgs.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "server/options.hpp"
#include "server/recognition.hpp"
#include "server/web/recent_log.hpp"

// What the page shows, as JSON. Results and tracks have theirs in core/io.

namespace bpa::server::web {

std::string status_json(const wire::bpa_msgs::GetStatus_Response& status);
std::string diagnostics_json(const wire::diagnostic_msgs::DiagnosticArray& diagnostics);
std::string log_json(const std::vector<RecentLog::Line>& lines);
/// Every parameter: name, type, value, default, range, description, whether it is read-only.
std::string parameters_json(const ServerOptions& options);
/// The parameter {"name": ..., "value": ...} of a request. Fails with invalid_argument, or
/// not_found where there is none of that name.
Result<wire::rcl_interfaces::Parameter> parameter_from_json(const std::string& text);
/// The models that are loaded, those of the folder that are not, and those that cannot be read.
std::string models_json(const Recognition& recognition, const std::vector<std::string>& in_folder);
std::string findings_json(const doctor::Findings& findings, bool running);
std::string score_terms_json(const std::vector<ScoreTerm>& terms);

/// A model's surface in binary: u32 number of points; f32 distance of neighbouring ones, metres;
/// x y z of each as f32, metres; r g b of each as u8; its normal as three i8, 127 for 1.
/// Little-endian. At most 12000 points, spread over the surface. The model has normals.
std::string surface_bytes(const ObjectModel& model);

}  // namespace bpa::server::web
