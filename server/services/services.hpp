// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/failure.hpp"
#include "core/base/guarded.hpp"
#include "core/base/log.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/qos.hpp"
#include "idl/wire/service.hpp"
#include "server/convert/results.hpp"
#include "server/services/parameter_setter.hpp"
#include "server/services/request_thread.hpp"
#include "server/services/requests.hpp"
#include "server/settings.hpp"

// A request that fails is answered with success = false, a code and a sentence; the server goes on.

namespace bpa::server {

/// Answers one request, once, from any thread.
template <class Service>
class Reply {
 public:
  using Request = typename Service::Request;
  using Response = typename Service::Response;

  Reply(wire::ReplyToken<Service> token, const Request& request, std::string service,
        const LogHook& log)
      : token_(std::move(token)),
        service_(std::move(service)),
        log_(hook_of_peer(log, wire::to_text(token_.client()))) {
    if constexpr (requires { request.frame.header; }) header_ = request.frame.header;
  }

  /// Never blocks; a reply that cannot be delivered is logged.
  void send(const Response& response) const {
    const Status sent = token_.reply(response);
    if (sent.ok()) return;
    bpa::log(log_, LogLevel::info, service_ + ": reply not delivered: " + sent.message);
  }
  /// The response that says why there is no other. A result in it has the request's header.
  Response refusal(const Status& status) const {
    Response response;
    if constexpr (requires { response.status.code; }) response.status = to_message(status);
    if constexpr (requires { response.result.header; }) {
      response.result.header = header_;
      response.result.status = response.status;
    }
    return response;
  }
  /// Says why the request is not answered, where the response has room for it; logs it anyway.
  void refuse(const Status& status, LogLevel severity = LogLevel::info) const {
    bpa::log(log_, severity, service_ + " refused: " + status.message);
    if constexpr (requires(Response response) { response.status.code; }) send(refusal(status));
  }
  /// Runs what answers the request. What it throws is a refusal.
  template <class Work>
  void guard(const Work& work) const {
    const Status status = guarded("the request failed", work);
    if (!status.ok()) refuse(status, LogLevel::error);
  }
  /// Who asks.
  wire::Guid client() const { return token_.client(); }
  /// For what this client causes.
  const LogHook& log() const { return log_; }
  Asker asker() const { return {client(), log_}; }

 private:
  wire::ReplyToken<Service> token_;
  std::string service_;
  LogHook log_;
  wire::std_msgs::Header header_;  ///< Of the request's frame.
};

/// Largest request of any service whose requests carry no frame, in bytes; larger ones are refused
/// before they are decoded.
inline constexpr std::size_t kMaxSmallRequest = 1 << 20;

/// Services that are offered from their add() until this is destroyed. One thread of its own
/// handles their requests.
class ServiceSet {
 public:
  /// `participant` outlives it.
  ServiceSet(const wire::Participant& participant, LogHook log,
             const wire::Qos& qos = wire::qos::services())
      : participant_(participant), log_(std::move(log)), qos_(qos) {}

  /// `handle(request, reply)` runs on the thread of these services; the reply may come later. What
  /// it throws is answered. Throws a Failure, as add_quick() does.
  template <class Service, class Handle>
  void add(const std::string& name, Handle handle, std::size_t max_request = kMaxSmallRequest) {
    using Request = typename Service::Request;
    const auto shared = std::make_shared<const Handle>(std::move(handle));
    auto server = or_throw(wire::ServiceServer<Service>::create(
        participant_, name,
        [this, name, shared](Request&& request, wire::ReplyToken<Service> token) {
          const Reply<Service> reply(std::move(token), request, name, log_);
          const auto own = std::make_shared<Request>(std::move(request));
          const auto work = [shared, own, reply] {
            reply.guard([&] { (*shared)(std::move(*own), reply); });
          };
          thread_.push(reply.client(), {work, [this, reply](const Status& status) {
                                          ++refused_;
                                          reply.refuse(status);
                                        }});
        },
        qos_, max_request));
    const auto kept = std::make_shared<wire::ServiceServer<Service>>(std::move(server));
    statistics_.push_back([raw = kept.get()] { return raw->statistics(); });
    servers_.push_back(kept);
  }
  /// `answer(request)` or `answer(request, hook)` gives the response at once; what the client
  /// causes is logged by the hook.
  template <class Service, class Answer>
  void add_quick(const std::string& name, Answer answer) {
    add<Service>(name, [answer = std::move(answer)](typename Service::Request&& request,
                                                    const Reply<Service>& reply) {
      if constexpr (std::is_invocable_v<Answer, typename Service::Request&&, const LogHook&>) {
        reply.send(answer(std::move(request), reply.log()));
      } else {
        reply.send(answer(std::move(request)));
      }
    });
  }

  /// What their thread does now.
  const Busy& busy() const { return thread_.busy(); }
  /// Of all services that were added.
  RequestLosses losses() const {
    RequestLosses sum{.refused = refused_};
    for (const auto& of_one : statistics_) {
      const wire::ServiceStatistics one = of_one();
      sum += {0, one.malformed, one.lost, one.replies_dropped};
    }
    return sum;
  }

 private:
  const wire::Participant& participant_;
  const LogHook log_;
  const wire::Qos qos_;
  std::atomic<std::uint64_t> refused_{0};  ///< Found no place in the queue.
  std::vector<std::function<wire::ServiceStatistics()>> statistics_;
  RequestThread thread_;
  std::vector<std::shared_ptr<void>> servers_;  ///< Last: they give the thread work.
};

class Tracking;

/// Offers `detect`. This and the next four throw a Failure.
void add_detect(const ServiceContext& context, ServiceSet& services);
/// Where a camera was: fixed_from_camera by its frame_id, at a stamp.
using FindCamera = std::function<Result<Pose>(const std::string& fixed_frame,
                                              const std::string& frame_id, std::int64_t stamp_ns)>;

/// Offers `detect_views`, whose searches take turns with changes of the library.
void add_detect_views(const ServiceContext& context, FindCamera camera, ServiceSet& services);
/// Offers `list_models`, `load_model` and `unload_model`.
void add_library_services(const ServiceContext& context, ServiceSet& services);
/// Offers `rename_track`, `hold_track` and `forget_track`; `tracking` outlives them.
void add_track_services(Tracking& tracking, ServiceSet& services);

/// Offers the services of every ROS 2 node for `ros2 param`: NODE/list_parameters, get_parameters,
/// get_parameter_types, describe_parameters, set_parameters and set_parameters_atomically.
/// `settings` outlives the services.
void add_parameter_services(const Settings& settings, std::shared_ptr<ParameterSetter> setter,
                            ServiceSet& services);

/// Offers NODE/get_type_description: what the types of this node's topics and services are made of.
/// Without a type_hash the name alone decides.
void add_type_description_service(ServiceSet& services);

}  // namespace bpa::server
