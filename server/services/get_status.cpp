// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/services/services.hpp"

namespace bpa::server {

Result<GetStatusServer> offer_get_status(const ServiceContext& context) {
  return GetStatusServer::create(
      context.participant, "get_status",
      [status = context.status, hook = context.log](
          wire::bpa_msgs::GetStatus_Request&&, wire::ReplyToken<wire::bpa_msgs::GetStatus> token) {
        const Status sent = token.reply(status());
        if (!sent.ok()) log(hook, LogLevel::info, "get_status: " + sent.message);
      });
}

}  // namespace bpa::server
