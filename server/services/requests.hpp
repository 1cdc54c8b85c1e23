// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/endpoint.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"
#include "server/advice.hpp"
#include "server/recognition.hpp"
#include "server/search_queue.hpp"
#include "server/settings.hpp"
#include "server/statistics.hpp"

// What requests do, however they come: over DDS (services.hpp) or from the page (server/web).

namespace bpa::server {

/// What requests need of the server; all of it outlives them.
struct ServiceContext {
  const Settings& settings;
  std::shared_ptr<Recognition> recognition;
  SearchQueue& queue;
  Statistics& statistics;
  Advice& advice;
  /// To be called after a model came or went.
  std::function<void()> library_changed;
  LogHook log;
};

/// Who asks.
struct Asker {
  wire::Guid client{};  ///< Clients take turns.
  LogHook log;          ///< For what this client causes.
};

/// Takes the one response to a request; from any thread.
template <class Service>
using Answer = std::function<void(const typename Service::Response&)>;

/// Whether these two of a request are in their ranges.
Status check_search(std::uint32_t top_k, double time_budget_ms);
/// What a request asks of a search but for its priors, with the server's settings where it leaves
/// the choice. Fails as check_search() does.
template <class Request>
Result<DetectRequest> search_of(const Request& request, const DetectionOptions& options) {
  if (Status s = check_search(request.top_k, request.time_budget_ms); !s.ok()) return s;
  DetectRequest search;
  search.models = request.models;
  search.top_k = request.top_k > 0 ? static_cast<int>(request.top_k) : options.top_k;
  search.budget_ms = request.time_budget_ms > 0 ? request.time_budget_ms : options.budget_ms;
  search.seed = request.seed > 0 ? request.seed : options.seed;
  search.num_threads = options.threads;
  return search;
}
/// The job of a request, with the server's settings where the request leaves the choice; its client
/// and `done` are left to the caller. Fails with invalid_argument.
Result<DetectJob> detect_job(wire::bpa_msgs::Detect_Request&& request,
                             const DetectionOptions& options);
/// Hands a job to the queue, or says why not and counts the refusal; `done` is not called then.
Status submit(const ServiceContext& context, Result<DetectJob> job);

wire::bpa_msgs::ListModels_Response list_models(const Recognition& recognition,
                                                const std::vector<std::string>& names);
/// These two wait for their turn in the queue: loading takes seconds.
void load_model(const ServiceContext& context, const Asker& asker,
                wire::bpa_msgs::LoadModel_Request request,
                const Answer<wire::bpa_msgs::LoadModel>& answer);
void unload_model(const ServiceContext& context, const Asker& asker,
                  wire::bpa_msgs::UnloadModel_Request request,
                  const Answer<wire::bpa_msgs::UnloadModel>& answer);

}  // namespace bpa::server
