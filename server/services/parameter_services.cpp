// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/services/parameter_services.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/time.hpp"
#include "server/parameters.hpp"

namespace bpa::server {
namespace {

namespace rcl = wire::rcl_interfaces;

rcl::SetParametersResult to_result(const Status& status) { return {status.ok(), status.message}; }

class Services : public ParameterServices {
 public:
  Services(const wire::Participant& participant, Settings& settings, LogHook log)
      : node_(participant.node().full()), settings_(settings), log_(std::move(log)) {}

  Status open(const wire::Participant& participant) {
    wire::PublisherOptions publishing;
    publishing.qos = wire::qos::parameters();
    auto events =
        wire::Publisher<rcl::ParameterEvent>::create(participant, "/parameter_events", publishing);
    if (!events.ok()) return events.status();
    events_.emplace(std::move(events).value());
    Status status = open_readers(participant);
    if (status.ok()) status = open_writers(participant);
    if (!status.ok()) return status;
    rcl::ParameterEvent event = new_event();
    event.new_parameters = all_parameters(*settings_.get());
    return events_->publish(event);
  }

 private:
  /// Offers a service below the node's name; `answer` makes the response of a request.
  template <class Service, class Answer>
  Status offer(const wire::Participant& participant, const char* name, Answer answer,
               std::optional<wire::ServiceServer<Service>>& place) {
    auto server = wire::ServiceServer<Service>::create(
        participant, std::string("~/") + name,
        [this, name, answer](typename Service::Request&& request,
                             const wire::ReplyToken<Service>& token) {
          const Status sent = token.reply(answer(request));
          if (!sent.ok()) log(log_, LogLevel::info, std::string(name) + ": " + sent.message);
        },
        wire::qos::parameters());
    if (!server.ok()) return server.status();
    place.emplace(std::move(server).value());
    return {};
  }

  Status open_readers(const wire::Participant& participant) {
    Status status = offer<rcl::ListParameters>(
        participant, "list_parameters",
        [](const rcl::ListParameters_Request& request) {
          return rcl::ListParameters_Response{list_parameters(request.prefixes, request.depth)};
        },
        list_);
    if (!status.ok()) return status;
    status = offer<rcl::GetParameters>(
        participant, "get_parameters",
        [this](const rcl::GetParameters_Request& request) {
          rcl::GetParameters_Response response;
          const Settings::Snapshot options = settings_.get();
          for (const std::string& name : request.names) {
            response.values.push_back(parameter(*options, name));
          }
          return response;
        },
        get_);
    if (!status.ok()) return status;
    status = offer<rcl::GetParameterTypes>(
        participant, "get_parameter_types",
        [](const rcl::GetParameterTypes_Request& request) {
          rcl::GetParameterTypes_Response response;
          for (const std::string& name : request.names) {
            response.types.push_back(describe_parameter(name).type);
          }
          return response;
        },
        types_);
    if (!status.ok()) return status;
    return offer<rcl::DescribeParameters>(
        participant, "describe_parameters",
        [](const rcl::DescribeParameters_Request& request) {
          rcl::DescribeParameters_Response response;
          for (const std::string& name : request.names) {
            response.descriptors.push_back(describe_parameter(name));
          }
          return response;
        },
        describe_);
  }

  Status open_writers(const wire::Participant& participant) {
    const Status status = offer<rcl::SetParameters>(
        participant, "set_parameters",
        [this](const rcl::SetParameters_Request& request) {
          rcl::SetParameters_Response response;
          for (const rcl::Parameter& parameter : request.parameters) {
            response.results.push_back(to_result(set({parameter})));
          }
          return response;
        },
        set_);
    if (!status.ok()) return status;
    return offer<rcl::SetParametersAtomically>(
        participant, "set_parameters_atomically",
        [this](const rcl::SetParametersAtomically_Request& request) {
          return rcl::SetParametersAtomically_Response{to_result(set(request.parameters))};
        },
        set_atomically_);
  }

  /// Sets all of them or none, and tells the world.
  Status set(const std::vector<rcl::Parameter>& parameters) {
    ServerOptions before, after;
    const Status status = settings_.change([&](ServerOptions& options) -> Status {
      before = options;
      for (const rcl::Parameter& parameter : parameters) {
        if (Status s = set_parameter(parameter, options); !s.ok()) return s;
      }
      after = options;
      return {};
    });
    if (!status.ok()) {
      log(log_, LogLevel::info, "parameters refused: " + status.message);
      return status;
    }
    rcl::ParameterEvent event = new_event();
    event.changed_parameters = changed_parameters(before, after);
    if (event.changed_parameters.empty()) return {};
    for (const rcl::Parameter& parameter : event.changed_parameters) {
      log(log_, LogLevel::info, "parameter " + parameter.name + " changed");
    }
    const Status told = events_->publish(event);
    if (!told.ok()) log(log_, LogLevel::warning, events_->topic() + ": " + told.message);
    return {};
  }

  rcl::ParameterEvent new_event() const {
    rcl::ParameterEvent event;
    event.stamp = wire::builtin_interfaces::from_ns(unix_time_ns());
    event.node = node_;
    return event;
  }

  const std::string node_;
  Settings& settings_;
  const LogHook log_;
  std::optional<wire::Publisher<rcl::ParameterEvent>> events_;
  // Last: their handlers use what stands above.
  std::optional<wire::ServiceServer<rcl::ListParameters>> list_;
  std::optional<wire::ServiceServer<rcl::GetParameters>> get_;
  std::optional<wire::ServiceServer<rcl::GetParameterTypes>> types_;
  std::optional<wire::ServiceServer<rcl::DescribeParameters>> describe_;
  std::optional<wire::ServiceServer<rcl::SetParameters>> set_;
  std::optional<wire::ServiceServer<rcl::SetParametersAtomically>> set_atomically_;
};

}  // namespace

Result<std::unique_ptr<ParameterServices>> ParameterServices::create(
    const wire::Participant& participant, Settings& settings, LogHook log) {
  auto services = std::make_unique<Services>(participant, settings, std::move(log));
  if (Status status = services->open(participant); !status.ok()) return status;
  return std::unique_ptr<ParameterServices>(std::move(services));
}

}  // namespace bpa::server
