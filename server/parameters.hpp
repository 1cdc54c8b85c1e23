// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "server/options.hpp"

// The settings as ROS 2 parameters: "group.key", such as detection.top_k; node.use_sim_time is
// use_sim_time, as every node has it. The types are those of the fields; the ranges are their
// rules; what may not change at run time is read-only.

namespace bpa::server {

inline constexpr const char* kUseSimTime = "use_sim_time";

/// Of ROS 2's parameter types, such as "string array".
const char* type_name(std::uint8_t type);

/// Every parameter, in the order of the settings.
std::vector<wire::rcl_interfaces::Parameter> all_parameters(const ServerOptions& options);

/// The value; of type kNotSet when there is no such parameter.
wire::rcl_interfaces::ParameterValue parameter(const ServerOptions& options,
                                               const std::string& name);

/// What is known of a parameter; of type kNotSet when there is none of that name.
wire::rcl_interfaces::ParameterDescriptor describe_parameter(const std::string& name);

/// Sets one field; ranges are left to validate(). `not_found` without such a parameter,
/// `unsupported` when it is read-only, `invalid_argument` for another type but integer for double.
Status set_parameter(const wire::rcl_interfaces::Parameter& parameter, ServerOptions& options);

/// The names below any of the prefixes (none: all), at most `depth` levels deep (0: no limit), and
/// the groups they are in, as rclcpp lists them.
wire::rcl_interfaces::ListParametersResult list_parameters(const std::vector<std::string>& prefixes,
                                                           std::uint64_t depth);

/// Those of `after` that differ from `before`.
std::vector<wire::rcl_interfaces::Parameter> changed_parameters(const ServerOptions& before,
                                                                const ServerOptions& after);

}  // namespace bpa::server
