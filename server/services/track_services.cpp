// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/services/services.hpp"
#include "server/tracking.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;

/// A service that edits a track: `edit(request)` gives the track's id.
template <class Service, class Edit>
void add_edit(const char* name, Edit edit, ServiceSet& services) {
  services.add_quick<Service>(
      name, [name, edit](const typename Service::Request& request, const LogHook& hook) {
        typename Service::Response response;
        const Result<std::uint64_t> id = edit(request);
        response.success = id.ok();
        response.status = to_message(id.status());
        if (id.ok()) response.id = *id;
        log(hook, LogLevel::info,
            std::string(name) + (id.ok() ? ": done" : " failed: " + id.status().message));
        return response;
      });
}

}  // namespace

void add_track_services(Tracking& tracking, ServiceSet& services) {
  add_edit<msgs::RenameTrack>(
      "rename_track",
      [&tracking](const auto& request) { return tracking.rename(request.track, request.name); },
      services);
  add_edit<msgs::HoldTrack>(
      "hold_track",
      [&tracking](const auto& request) { return tracking.hold(request.track, request.hold); },
      services);
  add_edit<msgs::ForgetTrack>(
      "forget_track", [&tracking](const auto& request) { return tracking.forget(request.track); },
      services);
}

}  // namespace bpa::server
