// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/services/parameter_services.hpp"

#include <utility>

#include "core/base/clock.hpp"
#include "idl/wire/time.hpp"
#include "server/parameters.hpp"

namespace bpa::server {
namespace {

namespace rcl = wire::rcl_interfaces;

rcl::SetParametersResult to_result(const Status& status) { return {status.ok(), status.message}; }

/// The response with `answer(name)` for every name of the request.
template <class Response, class Element, class Answer>
Response each(const std::vector<std::string>& names, std::vector<Element> Response::*list,
              Answer answer) {
  Response response;
  for (const std::string& name : names) (response.*list).push_back(answer(name));
  return response;
}

}  // namespace

ParameterServices::ParameterServices(const wire::Participant& participant,
                                     wire::Publisher<rcl::ParameterEvent> events,
                                     Settings& settings, LogHook log)
    : node_(participant.node().full()),
      settings_(settings),
      log_(log),
      events_(std::move(events)),
      services_(participant, std::move(log), wire::qos::parameters()) {}

Result<std::unique_ptr<ParameterServices>> ParameterServices::create(
    const wire::Participant& participant, Settings& settings, LogHook log) {
  wire::PublisherOptions publishing;
  publishing.qos = wire::qos::parameters();
  auto events =
      wire::Publisher<rcl::ParameterEvent>::create(participant, "/parameter_events", publishing);
  if (!events.ok()) return events.status();
  std::unique_ptr<ParameterServices> self(
      new ParameterServices(participant, std::move(events).value(), settings, std::move(log)));
  if (Status status = self->add_services(); !status.ok()) return status;
  rcl::ParameterEvent event = self->new_event();
  event.new_parameters = all_parameters(*settings.get());
  if (Status status = self->events_.publish(event); !status.ok()) return status;
  return self;
}

Status ParameterServices::add_services() {
  for (const Status& status :
       {services_.add_quick<rcl::ListParameters>(
            "~/list_parameters",
            [](const rcl::ListParameters_Request& request) {
              return rcl::ListParameters_Response{list_parameters(request.prefixes, request.depth)};
            }),
        services_.add_quick<rcl::GetParameters>(
            "~/get_parameters",
            [this](const rcl::GetParameters_Request& request) {
              const Settings::Snapshot options = settings_.get();
              return each(request.names, &rcl::GetParameters_Response::values,
                          [&](const std::string& name) { return parameter(*options, name); });
            }),
        services_.add_quick<rcl::GetParameterTypes>(
            "~/get_parameter_types",
            [](const rcl::GetParameterTypes_Request& request) {
              return each(request.names, &rcl::GetParameterTypes_Response::types,
                          [](const std::string& name) { return describe_parameter(name).type; });
            }),
        services_.add_quick<rcl::DescribeParameters>(
            "~/describe_parameters",
            [](const rcl::DescribeParameters_Request& request) {
              return each(request.names, &rcl::DescribeParameters_Response::descriptors,
                          describe_parameter);
            }),
        services_.add_quick<rcl::SetParameters>(
            "~/set_parameters",
            [this](const rcl::SetParameters_Request& request) {
              rcl::SetParameters_Response response;
              for (const rcl::Parameter& parameter : request.parameters) {
                response.results.push_back(to_result(set({parameter})));
              }
              return response;
            }),
        services_.add_quick<rcl::SetParametersAtomically>(
            "~/set_parameters_atomically",
            [this](const rcl::SetParametersAtomically_Request& request) {
              return rcl::SetParametersAtomically_Response{to_result(set(request.parameters))};
            })}) {
    if (!status.ok()) return status;
  }
  return {};
}

/// Sets all of them or none, and announces what changed.
Status ParameterServices::set(const Parameters& parameters) {
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
  const Status told = events_.publish(event);
  if (!told.ok()) log(log_, LogLevel::warning, events_.topic() + ": " + told.message);
  return {};
}

rcl::ParameterEvent ParameterServices::new_event() const {
  rcl::ParameterEvent event;
  event.stamp = wire::builtin_interfaces::from_ns(unix_time_ns());
  event.node = node_;
  return event;
}

}  // namespace bpa::server
