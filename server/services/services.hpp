// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "server/recognition.hpp"
#include "server/services/service_set.hpp"
#include "server/settings.hpp"
#include "server/statistics.hpp"
#include "server/worker.hpp"

// A request that fails is answered with success = false, a code and a sentence; the server goes on.

namespace bpa::server {

/// What the services need of the server; all of it outlives them.
struct ServiceContext {
  const Settings& settings;
  std::shared_ptr<Recognition> recognition;
  Worker& worker;
  Statistics& statistics;
  /// To be called after a model came or went.
  std::function<void()> library_changed;
  LogHook log;
};

/// Offers `detect`.
Status add_detect(const ServiceContext& context, ServiceSet& services);
/// Offers `list_models`, `load_model` and `unload_model`.
Status add_library_services(const ServiceContext& context, ServiceSet& services);

}  // namespace bpa::server
