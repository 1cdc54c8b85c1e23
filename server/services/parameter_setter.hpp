// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/log.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "idl/wire/participant.hpp"
#include "server/output.hpp"
#include "server/settings.hpp"

namespace bpa::server {

/// Changes settings on request, and says each change on /parameter_events. Thread-safe.
class ParameterSetter {
 public:
  /// Sends all parameters to /parameter_events. `settings` outlives it; `clock` stamps the events.
  /// Throws a Failure.
  ParameterSetter(const wire::Participant& participant, Settings& settings,
                  std::shared_ptr<const WaitableClock> clock);

  /// Sets all of them or none.
  wire::rcl_interfaces::SetParametersResult set(
      const std::vector<wire::rcl_interfaces::Parameter>& parameters, const LogHook& hook);

 private:
  wire::rcl_interfaces::ParameterEvent new_event() const;

  const std::string node_;
  Settings& settings_;
  const std::shared_ptr<const WaitableClock> clock_;
  std::mutex mutex_;  ///< Held while settings change, so that events are in the order of changes.
  Output<wire::rcl_interfaces::ParameterEvent> events_;
};

}  // namespace bpa::server
