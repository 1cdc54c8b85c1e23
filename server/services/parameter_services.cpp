// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0

#include "core/base/concat.hpp"
#include "core/base/failure.hpp"
#include "idl/wire/msg/rcl_interfaces.hpp"
#include "idl/wire/time.hpp"
#include "server/parameters.hpp"
#include "server/services/parameter_setter.hpp"
#include "server/services/services.hpp"

namespace bpa::server {
namespace {

namespace rcl = wire::rcl_interfaces;

/// Names that a request may have. There are about 150 parameters.
constexpr std::size_t kMaxNames = 1000;

/// Whether a request may be answered; otherwise it is logged, since these responses cannot say it.
bool is_short(const std::vector<std::string>& names, const LogHook& hook) {
  if (names.size() <= kMaxNames) return true;
  log(hook, LogLevel::warning,
      concat("a request about ", names.size(), " parameters has an empty answer; at most ",
             kMaxNames, " may be named"));
  return false;
}

/// The response with `answer(name)` for every name of the request; none where there are too many.
template <class Response, class Element, class Answer>
Response each(const std::vector<std::string>& names, const LogHook& hook,
              std::vector<Element> Response::*list, Answer answer) {
  Response response;
  if (!is_short(names, hook)) return response;
  for (const std::string& name : names) (response.*list).push_back(answer(name));
  return response;
}

}  // namespace

ParameterSetter::ParameterSetter(const wire::Participant& participant, Settings& settings,
                                 std::shared_ptr<const WaitableClock> clock)
    : node_(participant.node().full()), settings_(settings), clock_(std::move(clock)) {
  events_.open(participant, "/parameter_events", wire::qos::parameters());
  rcl::ParameterEvent event = new_event();
  event.new_parameters = all_parameters(*settings.get());
  or_throw(events_.publish(event));
}

rcl::ParameterEvent ParameterSetter::new_event() const {
  rcl::ParameterEvent event;
  event.stamp = wire::builtin_interfaces::from_ns(clock_->stamp_ns());
  event.node = node_;
  return event;
}

rcl::SetParametersResult ParameterSetter::set(const std::vector<rcl::Parameter>& parameters,
                                              const LogHook& hook) {
  if (parameters.size() > kMaxNames) {
    return {false, concat(parameters.size(), " parameters; at most ", kMaxNames, " may be set")};
  }
  const std::lock_guard<std::mutex> lock(mutex_);
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
    log(hook, LogLevel::info, "parameters refused: " + status.message);
    return {false, status.message};
  }
  rcl::ParameterEvent event = new_event();
  event.changed_parameters = changed_parameters(before, after);
  if (event.changed_parameters.empty()) return {true, ""};
  for (const rcl::Parameter& parameter : event.changed_parameters) {
    log(hook, LogLevel::info, "parameter " + parameter.name + " changed");
  }
  events_.send(event, hook);
  return {true, ""};
}

void add_parameter_services(const Settings& settings, std::shared_ptr<ParameterSetter> setter,
                            ServiceSet& services) {
  services.add_quick<rcl::ListParameters>(
      "~/list_parameters", [](const rcl::ListParameters_Request& request, const LogHook& hook) {
        if (!is_short(request.prefixes, hook)) return rcl::ListParameters_Response();
        return rcl::ListParameters_Response{list_parameters(request.prefixes, request.depth)};
      });
  services.add_quick<rcl::GetParameters>(
      "~/get_parameters",
      [&settings](const rcl::GetParameters_Request& request, const LogHook& hook) {
        const Settings::Snapshot options = settings.get();
        return each(request.names, hook, &rcl::GetParameters_Response::values,
                    [&](const std::string& name) { return parameter(*options, name); });
      });
  services.add_quick<rcl::GetParameterTypes>(
      "~/get_parameter_types",
      [](const rcl::GetParameterTypes_Request& request, const LogHook& hook) {
        return each(request.names, hook, &rcl::GetParameterTypes_Response::types,
                    [](const std::string& name) { return describe_parameter(name).type; });
      });
  services.add_quick<rcl::DescribeParameters>(
      "~/describe_parameters",
      [](const rcl::DescribeParameters_Request& request, const LogHook& hook) {
        return each(request.names, hook, &rcl::DescribeParameters_Response::descriptors,
                    describe_parameter);
      });
  services.add_quick<rcl::SetParameters>(
      "~/set_parameters", [setter](const rcl::SetParameters_Request& request, const LogHook& hook) {
        rcl::SetParameters_Response response;
        if (request.parameters.size() > kMaxNames) {
          response.results.push_back(setter->set(request.parameters, hook));  // which says so
          return response;
        }
        for (const rcl::Parameter& parameter : request.parameters) {
          response.results.push_back(setter->set({parameter}, hook));
        }
        return response;
      });
  services.add_quick<rcl::SetParametersAtomically>(
      "~/set_parameters_atomically",
      [setter](const rcl::SetParametersAtomically_Request& request, const LogHook& hook) {
        return rcl::SetParametersAtomically_Response{setter->set(request.parameters, hook)};
      });
}

}  // namespace bpa::server
