// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "server/convert/results.hpp"
#include "server/services/services.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;

msgs::ListModels_Response list(const Recognition& recognition,
                               const std::vector<std::string>& names) {
  msgs::ListModels_Response response;
  response.library = recognition.library();
  response.database_version = recognition.version();
  const Models models = recognition.models();
  const auto broken = recognition.broken();
  for (const std::string& name : names) {
    const auto has_name = [&](const auto& model) { return model->name == name; };
    if (std::ranges::any_of(models, has_name)) continue;
    const auto damaged = std::ranges::find(broken, name, &io::BrokenModel::name);
    response.status =
        to_message(damaged != broken.end()
                       ? damaged->reason
                       : Status(StatusCode::not_found, "there is no model named \"" + name + "\""));
    return response;
  }
  for (const auto& model : models) {
    const bool named = std::ranges::find(names, model->name) != names.end();
    if (named || names.empty()) response.models.push_back(model_message(*model));
  }
  response.success = true;
  if (names.empty()) response.status = to_message(io::explain_broken(response.library, broken));
  return response;
}

/// Fills in what both responses have, logs, tells the others and replies.
template <class Service>
void finish(const ServiceContext& context, const char* what, const Status& status,
            typename Service::Response& response, const Reply<Service>& reply) {
  response.success = status.ok();
  response.status = to_message(status);
  response.database_version = context.recognition->version();
  log(context.log, LogLevel::info,
      std::string(what) + (status.ok() ? ": done" : " failed: " + status.message));
  if (status.ok()) context.library_changed();
  reply.send(response);
}

/// A service that changes the library: `change(request, response)`. Loading takes seconds, so it
/// waits for its turn on the worker.
template <class Service, class Change>
void add_change(const ServiceContext& context, const char* name, Change change,
                ServiceSet& services) {
  services.add<Service>(name, [context, name, change](typename Service::Request&& request,
                                                      const Reply<Service>& reply) {
    const Status queued =
        context.worker.run_later([context, name, change, reply, request = std::move(request)] {
          typename Service::Response response;
          const Status status = change(request, response);
          finish(context, name, status, response, reply);
        });
    if (queued.ok()) return;
    typename Service::Response response;
    finish(context, name, queued, response, reply);
  });
}

}  // namespace

void add_library_services(const ServiceContext& context, ServiceSet& services) {
  const std::shared_ptr<Recognition> recognition = context.recognition;
  const auto list_models = [recognition](const msgs::ListModels_Request& request) {
    return list(*recognition, request.names);
  };
  const auto load = [recognition](const msgs::LoadModel_Request& request,
                                  msgs::LoadModel_Response& response) {
    const auto model = recognition->load(request.source, request.name);
    if (model.ok()) response.model = model_message(**model);
    return model.status();
  };
  const auto unload = [recognition](const msgs::UnloadModel_Request& request,
                                    msgs::UnloadModel_Response&) {
    return recognition->unload(request.name);
  };
  services.add_quick<msgs::ListModels>("list_models", list_models);
  add_change<msgs::LoadModel>(context, "load_model", load, services);
  add_change<msgs::UnloadModel>(context, "unload_model", unload, services);
}

}  // namespace bpa::server
