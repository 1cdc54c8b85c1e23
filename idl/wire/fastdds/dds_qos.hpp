// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "core/base/status.hpp"
#include "idl/wire/endpoint.hpp"
#include "idl/wire/fastdds/leases.hpp"
#include "idl/wire/fastdds/version.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/private/enclave.hpp"

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// UDP over IPv4 alone, with large buffers; discovery and security as rmw_fastrtps sets them up;
/// the user data by which ROS 2 knows one of its own. `leases` notes what comes in, where this sets
/// the transport and there is no security. `base` is the user's participant profile,
/// which then says the transports and time-outs; null: none. `invalid_argument` when a static
/// peer's name is unknown.
Result<dds::DomainParticipantQos> participant_qos(const Discovery& discovery,
                                                  const ParticipantOptions& options,
                                                  const Enclave& enclave,
                                                  std::shared_ptr<Leases> leases,
                                                  const dds::DomainParticipantQos* base);

/// The QoS of an endpoint. What spec.qos leaves open may come from the user's XML profiles: those
/// of the topic's DDS name, or "bpa_writer" and "bpa_reader".
dds::DataWriterQos writer_qos(const EndpointSpec& spec, const dds::Publisher& publisher);
dds::DataReaderQos reader_qos(const EndpointSpec& spec, const dds::Subscriber& subscriber);

Duration to_duration(std::int64_t ms);

/// What to tell the user about a peer that asks for more than is offered.
std::string incompatible_qos_text(const std::string& dds_topic, bool we_write,
                                  dds::QosPolicyId_t policy);

}  // namespace bpa::wire::detail
