// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/fastdds/dds_qos.hpp"

#include <algorithm>

#include <unistd.h>

#include "core/base/concat.hpp"

#if BPA_FASTDDS_MAJOR >= 3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#endif

namespace bpa::wire::detail {

using eprosima::fastdds::rtps::UDPv4TransportDescriptor;

namespace {

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
  if (discovery.range == DiscoveryRange::off) {
    // The peers' list must not be empty, or multicast takes its place.
    return add_peer("127.0.0.1", peers);
  }
  for (const std::string& peer : discovery.static_peers) {
    if (Status status = add_peer(peer, peers); !status.ok()) return status;
  }
  if (discovery.range == DiscoveryRange::localhost) return add_peer("127.0.0.1", peers);
  if (!discovery.static_peers.empty()) return add_peer("239.255.0.1", peers);
  return {};
}

/// UDP that receives what peers send, up to 65 500 bytes, and sends less at once. The descriptor's
/// own maxMessageSize is both: what exceeds it is cut off when it is received.
class UdpTransport : public UDPv4TransportDescriptor {
 public:
  UdpTransport(int datagram_bytes, std::shared_ptr<Leases> leases)
      : datagram_bytes_(static_cast<std::uint32_t>(datagram_bytes)), leases_(std::move(leases)) {}
  std::uint32_t max_message_size() const override { return datagram_bytes_; }
  eprosima::fastdds::rtps::TransportInterface* create_transport() const override {
    return leases_ == nullptr ? UDPv4TransportDescriptor::create_transport()
                              : transport_with_leases(*this, leases_);
  }

 private:
  std::uint32_t datagram_bytes_;
  std::shared_ptr<Leases> leases_;
};

/// UDP, and a short lease.
void use_our_transport(const Discovery& discovery, const ParticipantOptions& options,
                       std::shared_ptr<Leases> leases, dds::DomainParticipantQos& qos) {
  // Not the built-in ones: the shared-memory transport of Fast DDS 2.9.1 does not agree with that
  // of any other release, and the process that comes second aborts.
  auto udp = std::make_shared<UdpTransport>(options.datagram_bytes, std::move(leases));
  udp->sendBufferSize = static_cast<std::uint32_t>(options.socket_buffer_bytes);
  udp->receiveBufferSize = static_cast<std::uint32_t>(options.socket_buffer_bytes);
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

void use_security(const Enclave& enclave, dds::DomainParticipantQos& qos) {
  auto& properties = qos.properties().properties();
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  const auto add = [&](const EnclaveFile& file) {
    properties.emplace_back(file.property, concat("file://", enclave.folder, "/", file.name));
  };
  for (const EnclaveFile& file : kEnclaveFiles) add(file);
  if (access(concat(enclave.folder, "/", kRevokedFile.name).c_str(), F_OK) == 0) add(kRevokedFile);
}

/// The QoS of the user's XML profile of the topic or else of `profile`, or else `qos` as
/// `set_defaults` changes it; then what the spec says.
template <class EndpointQos, class Find, class SetDefaults>
EndpointQos endpoint_qos(const EndpointSpec& spec, EndpointQos qos, const char* profile, Find find,
                         SetDefaults set_defaults) {
  const bool has_profile = succeeded(find(spec.dds_topic, qos)) || succeeded(find(profile, qos));
  if (!has_profile) set_defaults(qos);
  const Qos& wanted = spec.qos;
  const int depth = std::max(wanted.depth, 1);
  qos.reliability().kind = wanted.reliability == Reliability::reliable
                               ? dds::RELIABLE_RELIABILITY_QOS
                               : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = wanted.durability == Durability::transient_local
                              ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  if (wanted.lifespan_ms > 0) qos.lifespan().duration = to_duration(wanted.lifespan_ms);

  auto& limits = qos.resource_limits();
  limits.max_samples = std::max(limits.max_samples, depth);
  limits.max_samples_per_instance = std::max(limits.max_samples_per_instance, depth);
  limits.allocated_samples = 1;

  qos.user_data().data_vec(std::vector<rtps::octet>(spec.user_data.begin(), spec.user_data.end()));
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  // Not shared memory: a process that is killed while it holds one of its locks takes the peers
  // with it. Fast DDS 2.9.1 throws in a thread of its own; later releases wait for ever.
  qos.data_sharing().off();
#if BPA_FASTDDS_MAJOR >= 3
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
#endif
  return qos;
}

}  // namespace

Duration to_duration(std::int64_t ms) {
  return Duration(static_cast<std::int32_t>(ms / 1000),
                  static_cast<std::uint32_t>(ms % 1000) * 1'000'000U);
}

Result<dds::DomainParticipantQos> participant_qos(const Discovery& discovery,
                                                  const ParticipantOptions& options,
                                                  const Enclave& enclave,
                                                  std::shared_ptr<Leases> leases,
                                                  const dds::DomainParticipantQos* base) {
  dds::DomainParticipantQos qos = base != nullptr ? *base : dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(enclave.name);
  const std::string user_data = "enclave=" + enclave.name + ";";
  qos.user_data().data_vec(std::vector<rtps::octet>(user_data.begin(), user_data.end()));
  if (enclave.secure()) use_security(enclave, qos);

#if BPA_FASTDDS_MAJOR >= 3
  // Announcing nothing of a type never refuses a peer; 2.x is told so by the type itself.
  qos.properties().properties().emplace_back("fastdds.type_propagation", "disabled");
#endif

  // With security Fast DDS 3 does not believe an open message that a peer left.
  if (enclave.secure()) leases = nullptr;
  if (base == nullptr) use_our_transport(discovery, options, std::move(leases), qos);
  if (discovery.range == DiscoveryRange::localhost || discovery.range == DiscoveryRange::off) {
    leave_multicast(qos);
  }
  if (discovery.range == DiscoveryRange::off) {
    qos.allocation().participants = {1, 1, 0};
  }
  if (Status status = set_peers(discovery, qos); !status.ok()) return status;
  return qos;
}

dds::DataWriterQos writer_qos(const EndpointSpec& spec, const dds::Publisher& publisher) {
  const auto find = [&](const std::string& profile, dds::DataWriterQos& qos) {
    return publisher.get_datawriter_qos_from_profile(profile, qos);
  };
  const auto set_defaults = [](dds::DataWriterQos& qos) {
    qos.reliability().max_blocking_time = to_duration(100);
    qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
    // With the default of 3 s, what is written while a peer is being matched comes seconds late.
    auto& times = qos.reliable_writer_qos().times;
#if BPA_FASTDDS_MAJOR >= 3
    times.heartbeat_period = to_duration(100);
    times.nack_response_delay = to_duration(1);
#else
    times.heartbeatPeriod = to_duration(100);
    times.nackResponseDelay = to_duration(1);
#endif
  };
  return endpoint_qos(spec, dds::DATAWRITER_QOS_DEFAULT, "bpa_writer", find, set_defaults);
}

dds::DataReaderQos reader_qos(const EndpointSpec& spec, const dds::Subscriber& subscriber) {
  const auto find = [&](const std::string& profile, dds::DataReaderQos& qos) {
    return subscriber.get_datareader_qos_from_profile(profile, qos);
  };
  const auto set_defaults = [](dds::DataReaderQos& qos) {
#if BPA_FASTDDS_MAJOR >= 3
    qos.reliable_reader_qos().times.heartbeat_response_delay = to_duration(1);
#else
    qos.reliable_reader_qos().times.heartbeatResponseDelay = to_duration(1);
#endif
  };
  return endpoint_qos(spec, dds::DATAREADER_QOS_DEFAULT, "bpa_reader", find, set_defaults);
}

std::string incompatible_qos_text(const std::string& dds_topic, bool we_write,
                                  dds::QosPolicyId_t policy) {
  const struct {
    dds::QosPolicyId_t policy;
    const char* name;
    const char* remedy;
  } known[] = {
      {dds::RELIABILITY_QOS_POLICY_ID, "reliability", "subscribe best_effort or publish reliable"},
      {dds::DURABILITY_QOS_POLICY_ID, "durability",
       "subscribe volatile or publish transient_local"},
      {dds::DEADLINE_QOS_POLICY_ID, "deadline", "subscribe without a deadline"},
      {dds::LIVELINESS_QOS_POLICY_ID, "liveliness",
       "subscribe with automatic liveliness and no lease"},
      {dds::DATAREPRESENTATION_QOS_POLICY_ID, "data representation", "give the peer XCDR1"}};
  std::string name = "policy " + std::to_string(static_cast<int>(policy));
  std::string remedy = "give both the same";
  for (const auto& one : known) {
    if (one.policy != policy) continue;
    name = one.name;
    remedy = one.remedy;
  }
  return "topic " + dds_topic + ": " +
         (we_write ? "a subscriber asks for more than we offer"
                   : "a publisher offers less than we ask for") +
         " in " + name + ", so they do not match: " + remedy;
}

}  // namespace bpa::wire::detail
