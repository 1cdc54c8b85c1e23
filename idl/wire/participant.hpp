// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/log.hpp"
#include "core/base/status.hpp"
#include "idl/wire/names.hpp"

namespace bpa::wire {

namespace detail {
class ParticipantImpl;
}

// How far a participant looks for others.

enum class DiscoveryRange {
  subnet,            ///< Multicast on the network, and the static peers.
  localhost,         ///< This machine only, as ROS 2 Iron and later do it; and the static peers.
  off,               ///< No discovery.
  humble_localhost,  ///< This machine only, by the loopback interface alone, as Humble does it.
};

struct Discovery {
  int domain_id = 0;  ///< 0 to 232.
  DiscoveryRange range = DiscoveryRange::subnet;
  std::vector<std::string> static_peers;  ///< Host names or IPv4 addresses.
};

/// From ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY
/// (which overrides the others and ignores the peers), as rcl reads them. `invalid_argument` names
/// the variable whose value is not legal.
Result<Discovery> discovery_from_environment();

/// The size of ids in ros_discovery_info: Humble misreads that of Iron and later, and the reverse.
enum class GraphLayout {
  automatic,  ///< iron16, and humble24 while every ROS 2 peer that was discovered is a Humble one.
  iron16,
  humble24,
};

/// DDS Security, with what a keystore of SROS 2 has for an enclave. Peers that have nothing of the
/// same authorities see no topic, and peers of an enclave that may not use one cannot.
struct SecurityOptions {
  std::string keystore;       ///< A folder; empty: as ROS_SECURITY_ENABLE and its like say.
  std::string enclave = "/";  ///< "/robot" is the folder enclaves/robot of the keystore.
};

struct ParticipantOptions {
  NodeName node;                       ///< How ROS 2 tools show this process.
  std::vector<Remap> remaps;           ///< Applied to every topic and service name.
  std::optional<Discovery> discovery;  ///< None: from the environment.
  SecurityOptions security;
  GraphLayout graph_layout = GraphLayout::automatic;
  /// A file of Fast DDS XML profiles; empty: only those that Fast DDS loads by itself. The
  /// participant profile "bpa" replaces our transports and time-outs. Profiles "bpa_writer",
  /// "bpa_reader" and those named like a DDS topic set what Qos leaves open.
  std::string profiles;
  int socket_buffer_bytes = 8'388'608;  ///< Asked of the kernel, which may give less (rmem_max).
  /// Largest UDP datagram that is sent. A lost packet of some 1500 bytes costs all of its datagram.
  int datagram_bytes = 8900;
  LogHook log;  ///< Called from DDS threads.
};

/// A process's seat in the DDS domain and its node in the ROS 2 graph; one a process. UDP over IPv4
/// only, no shared-memory transport. Publishers, subscribers and services keep it alive.
class Participant {
 public:
  /// `invalid_argument` for bad names or a bad environment, `unavailable` when DDS cannot start. Of
  /// security: `not_found` for a missing file, `unsupported` where Fast DDS has none.
  static Result<Participant> create(ParticipantOptions options);

  const NodeName& node() const;
  int domain_id() const;
  /// Where the keys lie that protect it; empty: without security.
  const std::string& enclave_folder() const;
  /// The fully qualified name of a topic or service, remapped.
  Result<std::string> resolve(std::string_view name) const;
  /// The layout in use now; never `automatic`.
  GraphLayout graph_layout() const;

  const std::shared_ptr<detail::ParticipantImpl>& impl() const { return impl_; }

 private:
  explicit Participant(std::shared_ptr<detail::ParticipantImpl> impl);
  std::shared_ptr<detail::ParticipantImpl> impl_;
};

}  // namespace bpa::wire
