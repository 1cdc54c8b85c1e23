// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include <bpa/wire/endpoint.hpp>

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

eprosima::fastdds::dds::DataWriterQos writer_qos(const EndpointSpec& spec);
eprosima::fastdds::dds::DataReaderQos reader_qos(const EndpointSpec& spec);

/// What to tell the user about a peer that asks for more than is offered.
std::string incompatible_qos_text(const std::string& dds_topic, bool we_write,
                                  eprosima::fastdds::dds::QosPolicyId_t policy);

}  // namespace bpa::wire::detail
