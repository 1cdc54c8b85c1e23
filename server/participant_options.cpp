// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/participant_options.hpp"

#include <string>
#include <utility>

#include "core/base/failure.hpp"
#include "idl/wire/middleware.hpp"

namespace bpa::server {
namespace {

wire::Discovery discovery_of(const NetworkOptions& options) {
  wire::Discovery discovery = or_throw(wire::discovery_from_environment());
  if (options.domain >= 0) discovery.domain_id = options.domain;
  if (options.range == "subnet") discovery.range = wire::DiscoveryRange::subnet;
  if (options.range == "localhost") discovery.range = wire::DiscoveryRange::localhost;
  if (options.range == "humble_localhost") discovery.range = wire::DiscoveryRange::humble_localhost;
  if (options.range == "off") discovery.range = wire::DiscoveryRange::off;
  discovery.static_peers.insert(discovery.static_peers.end(), options.peers.begin(),
                                options.peers.end());
  return discovery;
}

wire::GraphLayout graph_layout_of(const std::string& word) {
  if (word == "humble") return wire::GraphLayout::humble24;
  return word == "iron" ? wire::GraphLayout::iron16 : wire::GraphLayout::automatic;
}

}  // namespace

wire::ParticipantOptions participant_options(const ServerOptions& options, LogHook log) {
  for (const auto& note : wire::check_middleware(options.network.range == "environment")) {
    bpa::log(log, LogLevel::warning, wire::line_of(note));
  }
  wire::ParticipantOptions seat;
  seat.node = {options.node.ros_namespace, options.node.name};
  seat.discovery = discovery_of(options.network);
  seat.graph_layout = graph_layout_of(options.network.graph_layout);
  seat.profiles = options.network.profiles;
  seat.datagram_bytes = options.network.datagram_bytes;
  seat.security = {options.security.keystore, options.security.enclave};
  seat.log = std::move(log);
  for (const std::string& text : options.node.remaps) {
    seat.remaps.push_back(or_throw(wire::parse_remap(text)));
  }
  return seat;
}

}  // namespace bpa::server
