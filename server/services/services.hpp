// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <bpa/core/base/log.hpp>
#include <bpa/core/base/status.hpp>
#include <bpa/server/recognition.hpp>
#include <bpa/server/settings.hpp>
#include <bpa/server/statistics.hpp>
#include <bpa/server/worker.hpp>
#include <bpa/wire/messages.hpp>
#include <bpa/wire/participant.hpp>
#include <bpa/wire/service.hpp>

// One function per service: each offers it until the returned object is destroyed. A request that
// fails is answered with success = false, a code and a sentence; the server goes on.

namespace bpa::server {

/// What the services need of the server; all of it outlives them.
struct ServiceContext {
  const wire::Participant& participant;
  const Settings& settings;
  std::shared_ptr<const Recognition> recognition;
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
