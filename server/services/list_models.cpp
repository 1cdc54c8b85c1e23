// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

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
    const bool known = std::any_of(models.begin(), models.end(),
                                   [&](const auto& model) { return model->name == name; });
    if (known) continue;
    const auto damaged = std::find_if(broken.begin(), broken.end(),
                                      [&](const auto& model) { return model.name == name; });
    response.status =
        to_message(damaged != broken.end()
                       ? damaged->reason
                       : Status(StatusCode::not_found, "there is no model named \"" + name + "\""));
    return response;
  }
  for (const auto& model : models) {
    const bool wanted =
        names.empty() || std::find(names.begin(), names.end(), model->name) != names.end();
    if (wanted) response.models.push_back(model_message(*model));
  }
  response.success = true;
  if (names.empty()) response.status = to_message(io::explain_broken(response.library, broken));
  return response;
}

}  // namespace

Result<ListModelsServer> offer_list_models(const ServiceContext& context) {
  return ListModelsServer::create(
      context.participant, "list_models",
      [recognition = context.recognition, hook = context.log](
          msgs::ListModels_Request&& request, wire::ReplyToken<msgs::ListModels> token) {
        const Status status = token.reply(list(*recognition, request.names));
        if (!status.ok()) log(hook, LogLevel::info, "list_models: " + status.message);
      });
}

}  // namespace bpa::server
