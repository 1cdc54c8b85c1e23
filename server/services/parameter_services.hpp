// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/publisher.hpp"
#include "server/services/service_set.hpp"
#include "server/settings.hpp"

namespace bpa::server {

/// What every ROS 2 node has for `ros2 param`: the services NODE/list_parameters, get_parameters,
/// get_parameter_types, describe_parameters, set_parameters and set_parameters_atomically, and
/// /parameter_events, on which all parameters are announced at the start and then each change.
class ParameterServices {
 public:
  /// `participant` and `settings` outlive it.
  static Result<std::unique_ptr<ParameterServices>> create(const wire::Participant& participant,
                                                           Settings& settings, LogHook log);

 private:
  using Parameters = std::vector<wire::rcl_interfaces::Parameter>;

  ParameterServices(const wire::Participant& participant,
                    wire::Publisher<wire::rcl_interfaces::ParameterEvent> events,
                    Settings& settings, LogHook log);
  Status add_services();
  Status set(const Parameters& parameters);
  wire::rcl_interfaces::ParameterEvent new_event() const;

  const std::string node_;
  Settings& settings_;
  const LogHook log_;
  wire::Publisher<wire::rcl_interfaces::ParameterEvent> events_;
  ServiceSet services_;  ///< Last: its handlers use what stands above.
};

}  // namespace bpa::server
