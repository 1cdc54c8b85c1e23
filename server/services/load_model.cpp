// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "server/convert/results.hpp"
#include "server/services/services.hpp"

// Loading takes seconds, so it waits for its turn on the worker.

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;

/// Fills in what both responses have, logs, tells the others and replies.
template <class Service>
void finish(const ServiceContext& context, const char* what, const Status& status,
            typename Service::Response& response, const wire::ReplyToken<Service>& token) {
  response.success = status.ok();
  response.status = to_message(status);
  response.database_version = context.recognition->version();
  log(context.log, LogLevel::info,
      std::string(what) + (status.ok() ? ": done" : " failed: " + status.message));
  if (status.ok()) context.library_changed();
  const Status sent = token.reply(response);
  if (!sent.ok()) log(context.log, LogLevel::info, std::string(what) + ": " + sent.message);
}

void load(const ServiceContext& context, const msgs::LoadModel_Request& request,
          const wire::ReplyToken<msgs::LoadModel>& token) {
  msgs::LoadModel_Response response;
  const auto model = context.recognition->load(request.source, request.name);
  if (model.ok()) response.model = model_message(**model);
  finish(context, "load_model", model.status(), response, token);
}

void unload(const ServiceContext& context, const msgs::UnloadModel_Request& request,
            const wire::ReplyToken<msgs::UnloadModel>& token) {
  msgs::UnloadModel_Response response;
  const Status status = context.recognition->unload(request.name);
  finish(context, "unload_model", status, response, token);
}

/// A service whose requests `work` answers on the worker.
template <class Service, class Work>
Result<wire::ServiceServer<Service>> offer(const ServiceContext& context, const char* name,
                                           Work work) {
  return wire::ServiceServer<Service>::create(
      context.participant, name,
      [context, name, work](typename Service::Request&& request, wire::ReplyToken<Service> token) {
        const Status queued =
            context.worker.run_later([context, work, token, request = std::move(request)] {
              work(context, request, token);
            });
        if (queued.ok()) return;
        typename Service::Response response;
        finish(context, name, queued, response, token);
      });
}

}  // namespace

Result<LoadModelServer> offer_load_model(const ServiceContext& context) {
  return offer<msgs::LoadModel>(context, "load_model", load);
}

Result<UnloadModelServer> offer_unload_model(const ServiceContext& context) {
  return offer<msgs::UnloadModel>(context, "unload_model", unload);
}

}  // namespace bpa::server
