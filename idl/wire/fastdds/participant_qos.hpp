// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "core/base/status.hpp"
#include "idl/wire/discovery.hpp"

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// UDP over IPv4 alone, with large buffers; discovery as rmw_fastrtps sets it up; the user data by
/// which ROS 2 knows one of its own. `base` is the participant profile of the user, which then says
/// which transports and time-outs there are; null: none. `invalid_argument` when a static peer's
/// name is unknown.
Result<eprosima::fastdds::dds::DomainParticipantQos> participant_qos(
    const Discovery& discovery, int socket_buffer_bytes,
    const eprosima::fastdds::dds::DomainParticipantQos* base);

}  // namespace bpa::wire::detail
