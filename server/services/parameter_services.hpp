// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/participant.hpp"
#include "server/settings.hpp"

namespace bpa::server {

/// What every ROS 2 node has for `ros2 param`: the services NODE/list_parameters, get_parameters,
/// get_parameter_types, describe_parameters, set_parameters and set_parameters_atomically, and
/// /parameter_events, on which all parameters are announced at the start and then each change.
class ParameterServices {
 public:
  /// `settings` outlives it.
  static Result<std::unique_ptr<ParameterServices>> create(const wire::Participant& participant,
                                                           Settings& settings, LogHook log);
  virtual ~ParameterServices() = default;
};

}  // namespace bpa::server
