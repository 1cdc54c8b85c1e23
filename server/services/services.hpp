// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "core/base/log.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/qos.hpp"
#include "idl/wire/service.hpp"
#include "server/convert/results.hpp"
#include "server/recognition.hpp"
#include "server/settings.hpp"
#include "server/statistics.hpp"
#include "server/worker.hpp"

// A request that fails is answered with success = false, a code and a sentence; the server goes on.

namespace bpa::server {

/// Answers one request, once, from any thread.
template <class Service>
class Reply {
 public:
  Reply(wire::ReplyToken<Service> token, std::string service, LogHook log)
      : token_(std::move(token)), service_(std::move(service)), log_(std::move(log)) {}

  /// Never blocks; a reply that cannot be delivered is logged.
  void send(const typename Service::Response& response) const {
    const Status sent = token_.reply(response);
    if (!sent.ok()) log(log_, LogLevel::info, service_ + ": reply not delivered: " + sent.message);
  }
  /// Runs what answers the request. What it throws is logged and, where the response has room for
  /// it, answered.
  template <class Work>
  void guard(const Work& work) const {
    const Status status = guarded("the request failed", work);
    if (status.ok()) return;
    log(log_, LogLevel::error, service_ + ": " + status.message);
    typename Service::Response response;
    if constexpr (requires { response.status.code; }) {
      response.status = to_message(status);
      send(response);
    }
  }
  /// Who asks.
  wire::Guid client() const { return token_.client(); }

 private:
  wire::ReplyToken<Service> token_;
  std::string service_;
  LogHook log_;
};

/// Services that are offered from their add() until this is destroyed.
class ServiceSet {
 public:
  /// `participant` outlives it.
  ServiceSet(const wire::Participant& participant, LogHook log,
             const wire::Qos& qos = wire::qos::services())
      : participant_(participant), log_(std::move(log)), qos_(qos) {}

  /// `handle(request, reply)` runs on a DDS thread and must not block; the reply may come later.
  /// What it throws is answered. Throws a Failure, as add_quick() does.
  template <class Service, class Handle>
  void add(const std::string& name, Handle handle) {
    auto server = or_throw(wire::ServiceServer<Service>::create(
        participant_, name,
        [name, handle = std::move(handle), log = log_](typename Service::Request&& request,
                                                       wire::ReplyToken<Service> token) {
          const Reply<Service> reply(std::move(token), name, log);
          reply.guard([&] { handle(std::move(request), reply); });
        },
        qos_));
    servers_.push_back(std::make_shared<wire::ServiceServer<Service>>(std::move(server)));
  }
  /// `answer(request)` gives the response at once.
  template <class Service, class Answer>
  void add_quick(const std::string& name, Answer answer) {
    add<Service>(name, [answer = std::move(answer)](typename Service::Request&& request,
                                                    const Reply<Service>& reply) {
      reply.send(answer(std::move(request)));
    });
  }

 private:
  const wire::Participant& participant_;
  const LogHook log_;
  const wire::Qos qos_;
  std::vector<std::shared_ptr<void>> servers_;
};

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

/// Offers `detect`. This and the next two throw a Failure.
void add_detect(const ServiceContext& context, ServiceSet& services);
/// Offers `list_models`, `load_model` and `unload_model`.
void add_library_services(const ServiceContext& context, ServiceSet& services);

/// Offers the services of every ROS 2 node for `ros2 param`: NODE/list_parameters, get_parameters,
/// get_parameter_types, describe_parameters, set_parameters and set_parameters_atomically. Also
/// /parameter_events: all parameters at the start, then each change. `participant` and `settings`
/// outlive the services.
void add_parameter_services(const wire::Participant& participant, Settings& settings,
                            const LogHook& log, ServiceSet& services);

}  // namespace bpa::server
