// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "idl/wire/endpoint.hpp"
#include "idl/wire/fastdds/version.hpp"

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// The QoS of an endpoint; what spec.qos does not say may come from the user's XML profiles, those
/// of the topic's DDS name or "bpa_writer" and "bpa_reader".
dds::DataWriterQos writer_qos(const EndpointSpec& spec, const dds::Publisher& publisher);
dds::DataReaderQos reader_qos(const EndpointSpec& spec, const dds::Subscriber& subscriber);

/// What to tell the user about a peer that asks for more than is offered.
std::string incompatible_qos_text(const std::string& dds_topic, bool we_write,
                                  dds::QosPolicyId_t policy);

}  // namespace bpa::wire::detail
