// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "idl/wire/fastdds/dds_qos.hpp"
#include "idl/wire/fastdds/version.hpp"

#if BPA_FASTDDS_MAJOR >= 3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#endif

namespace bpa::wire::detail {

using eprosima::fastdds::rtps::UDPv4TransportDescriptor;

namespace {

constexpr const char* kRosUserData = "enclave=/;";
constexpr const char* kRosParticipantName = "/";
constexpr std::uint32_t kPeersOnOneHost = 32;  // ports tried at a peer's address, as rmw does

Status add_peer(const std::string& peer, rtps::LocatorList_t& peers) {
  std::string address = peer;
  if (!IPLocator::isIPv4(peer)) {
    const auto addresses = IPLocator::resolveNameDNS(peer).first;
    if (addresses.empty())
      return invalid_argument("static peer '" + peer + "' has no IPv4 address");
    address = *addresses.begin();
  }
  rtps::Locator_t locator;  // port 0: those of the domain
  IPLocator::setIPv4(locator, address);
  peers.push_back(locator);
  return {};
}

/// A metatraffic locator that is given keeps Fast DDS from adding the multicast one.
void leave_multicast(dds::DomainParticipantQos& qos) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.metatrafficMulticastLocatorList.clear();
  builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
}

Status set_peers(const Discovery& discovery, dds::DomainParticipantQos& qos) {
  rtps::LocatorList_t& peers = qos.wire_protocol().builtin.initialPeersList;
  Status status;
  if (discovery.range == DiscoveryRange::off) {
    // The peers' list must not be empty, or multicast takes its place.
    return add_peer("127.0.0.1", peers);
  }
  for (const std::string& peer : discovery.static_peers) {
    status = add_peer(peer, peers);
    if (!status.ok()) return status;
  }
  if (discovery.range == DiscoveryRange::localhost) return add_peer("127.0.0.1", peers);
  if (!discovery.static_peers.empty()) return add_peer("239.255.0.1", peers);
  return status;
}

/// UDP, and a short lease.
void use_our_transport(const Discovery& discovery, int socket_buffer_bytes,
                       dds::DomainParticipantQos& qos) {
  // Not the built-in ones: the shared-memory transport of Fast DDS 2.9.1 does not agree with that
  // of any other release, and the process that comes second aborts.
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->sendBufferSize = static_cast<std::uint32_t>(socket_buffer_bytes);
  udp->receiveBufferSize = static_cast<std::uint32_t>(socket_buffer_bytes);
  udp->maxInitialPeersRange = kPeersOnOneHost;
  if (discovery.range == DiscoveryRange::humble_localhost) {
    udp->interfaceWhiteList.push_back("127.0.0.1");
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);

  // A peer that died without a word is noticed after 5 s.
  auto& config = qos.wire_protocol().builtin.discovery_config;
  config.leaseDuration = Duration(5, 0);
  config.leaseDuration_announcementperiod = Duration(1, 500'000'000);
}

}  // namespace

Result<dds::DomainParticipantQos> participant_qos(const Discovery& discovery,
                                                  int socket_buffer_bytes,
                                                  const dds::DomainParticipantQos* base) {
  dds::DomainParticipantQos qos = base != nullptr ? *base : dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(kRosParticipantName);
  qos.user_data().data_vec(
      std::vector<rtps::octet>(kRosUserData, kRosUserData + std::strlen(kRosUserData)));

#if BPA_FASTDDS_MAJOR >= 3
  // Announcing nothing of a type never refuses a peer; 2.x is told so by the type itself.
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
#endif

  if (base == nullptr) use_our_transport(discovery, socket_buffer_bytes, qos);
  if (discovery.range == DiscoveryRange::localhost || discovery.range == DiscoveryRange::off) {
    leave_multicast(qos);
  }
  if (discovery.range == DiscoveryRange::off) {
    qos.allocation().participants.initial = 1;
    qos.allocation().participants.maximum = 1;
    qos.allocation().participants.increment = 0;
  }
  Status status = set_peers(discovery, qos);
  if (!status.ok()) return status;
  return qos;
}

}  // namespace bpa::wire::detail
