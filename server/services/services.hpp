// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/service.hpp"
#include "server/recognition.hpp"
#include "server/settings.hpp"
#include "server/statistics.hpp"
#include "server/worker.hpp"

// One function per service: each offers it until the returned object is destroyed. A request that
// fails is answered with success = false, a code and a sentence; the server goes on.

namespace bpa::server {

/// What the services need of the server; all of it outlives them.
struct ServiceContext {
  const wire::Participant& participant;
  const Settings& settings;
  std::shared_ptr<Recognition> recognition;
  Worker& worker;
  Statistics& statistics;
  /// Fills in what the server knows: uptime, queue, causes of drops.
  std::function<wire::bpa_msgs::GetStatus_Response()> status;
  /// To be called after a model came or went.
  std::function<void()> library_changed;
  LogHook log;
};

using DetectServer = wire::ServiceServer<wire::bpa_msgs::Detect>;
using ListModelsServer = wire::ServiceServer<wire::bpa_msgs::ListModels>;
using LoadModelServer = wire::ServiceServer<wire::bpa_msgs::LoadModel>;
using UnloadModelServer = wire::ServiceServer<wire::bpa_msgs::UnloadModel>;
using GetStatusServer = wire::ServiceServer<wire::bpa_msgs::GetStatus>;

Result<DetectServer> offer_detect(const ServiceContext& context);
Result<ListModelsServer> offer_list_models(const ServiceContext& context);
Result<LoadModelServer> offer_load_model(const ServiceContext& context);
Result<UnloadModelServer> offer_unload_model(const ServiceContext& context);
Result<GetStatusServer> offer_get_status(const ServiceContext& context);

}  // namespace bpa::server
