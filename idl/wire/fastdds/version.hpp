// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// What the two generations of Fast DDS call differently: 2.9 (Debian 12) and 3 (Debian 13). Code
// that needs more than another name asks BPA_FASTDDS_MAJOR, which CMake defines. Private to
// idl/wire/fastdds, the only folder that includes Fast DDS.

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#if BPA_FASTDDS_MAJOR >= 3
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/status/SampleRejectedStatus.hpp>
#include <fastdds/rtps/common/WriteParams.hpp>
#include <fastdds/utils/IPLocator.hpp>
#else
#include <fastrtps/qos/SampleRejectedStatus.hpp>
#include <fastrtps/types/TypesBase.h>
#include <fastrtps/utils/IPLocator.h>
#endif

namespace bpa::wire::detail {

namespace dds = eprosima::fastdds::dds;

#if BPA_FASTDDS_MAJOR >= 3

namespace rtps = eprosima::fastdds::rtps;
using Duration = dds::Duration_t;
using dds::SampleRejectedStatus;
using rtps::IPLocator;

inline bool succeeded(dds::ReturnCode_t code) { return code == dds::RETCODE_OK; }

#else

namespace rtps = eprosima::fastrtps::rtps;
using Duration = eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::SampleRejectedStatus;
using rtps::IPLocator;

inline bool succeeded(bool written) { return written; }
inline bool succeeded(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}

#endif

}  // namespace bpa::wire::detail
