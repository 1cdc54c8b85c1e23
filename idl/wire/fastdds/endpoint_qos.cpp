// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

#include "idl/wire/fastdds/dds_qos.hpp"

namespace bpa::wire::detail {

namespace {

/// Equal for two processes just when they can open each other's memory: the same machine since its
/// start, the same /dev/shm, the same user, the same build of Fast DDS.
std::uint64_t sharing_domain() {
  std::string boot_id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot_id;
  struct stat shm = {};
  const bool has_shm = stat("/dev/shm", &shm) == 0;
  const std::string key = "bpa " BPA_FASTDDS_VERSION " " + boot_id + " " +
                          std::to_string(has_shm ? shm.st_dev : 0) + " " +
                          std::to_string(geteuid());
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a
  for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

Duration milliseconds(std::int64_t ms) {
  return Duration(static_cast<std::int32_t>(ms / 1000),
                  static_cast<std::uint32_t>(ms % 1000) * 1'000'000U);
}

/// What writers and readers have in common. The defaults are read first, then changed.
template <class EndpointQos>
void set_common(const EndpointSpec& spec, EndpointQos& qos) {
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
  if (wanted.lifespan_ms > 0) qos.lifespan().duration = milliseconds(wanted.lifespan_ms);

  auto& limits = qos.resource_limits();
  limits.max_samples = std::max(limits.max_samples, depth);
  limits.max_samples_per_instance = std::max(limits.max_samples_per_instance, depth);
  limits.allocated_samples = 1;

  qos.user_data().data_vec(std::vector<rtps::octet>(spec.user_data.begin(), spec.user_data.end()));
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  if (spec.shared_bytes > 0) {
    qos.data_sharing().automatic();
    qos.data_sharing().add_domain_id(sharing_domain());
  } else {
    qos.data_sharing().off();
  }
#if BPA_FASTDDS_MAJOR >= 3
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
#endif
}

}  // namespace

dds::DataWriterQos writer_qos(const EndpointSpec& spec, const dds::Publisher& publisher) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  const bool has_profile =
      succeeded(publisher.get_datawriter_qos_from_profile(spec.dds_topic, qos)) ||
      succeeded(publisher.get_datawriter_qos_from_profile("bpa_writer", qos));
  set_common(spec, qos);
  if (!has_profile) {
    qos.reliability().max_blocking_time = milliseconds(100);
    qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
    // With the default of 3 s, what is written while a peer is being matched comes seconds late.
    auto& times = qos.reliable_writer_qos().times;
#if BPA_FASTDDS_MAJOR >= 3
    times.heartbeat_period = milliseconds(100);
    times.nack_response_delay = milliseconds(1);
#else
    times.heartbeatPeriod = milliseconds(100);
    times.nackResponseDelay = milliseconds(1);
#endif
  }
  return qos;
}

dds::DataReaderQos reader_qos(const EndpointSpec& spec, const dds::Subscriber& subscriber) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  const bool has_profile =
      succeeded(subscriber.get_datareader_qos_from_profile(spec.dds_topic, qos)) ||
      succeeded(subscriber.get_datareader_qos_from_profile("bpa_reader", qos));
  set_common(spec, qos);
  if (!has_profile) {
    auto& times = qos.reliable_reader_qos().times;
#if BPA_FASTDDS_MAJOR >= 3
    times.heartbeat_response_delay = milliseconds(1);
#else
    times.heartbeatResponseDelay = milliseconds(1);
#endif
  }
  return qos;
}

std::string incompatible_qos_text(const std::string& dds_topic, bool we_write,
                                  dds::QosPolicyId_t policy) {
  std::string name = "policy " + std::to_string(static_cast<int>(policy));
  std::string remedy = "give both the same";
  if (policy == dds::RELIABILITY_QOS_POLICY_ID) {
    name = "reliability";
    remedy = "subscribe best_effort or publish reliable";
  } else if (policy == dds::DURABILITY_QOS_POLICY_ID) {
    name = "durability";
    remedy = "subscribe volatile or publish transient_local";
  } else if (policy == dds::DEADLINE_QOS_POLICY_ID) {
    name = "deadline";
    remedy = "subscribe without a deadline";
  } else if (policy == dds::LIVELINESS_QOS_POLICY_ID) {
    name = "liveliness";
    remedy = "subscribe with automatic liveliness and no lease";
  }
  return "topic " + dds_topic + ": " +
         (we_write ? "a subscriber asks for more than we offer"
                   : "a publisher offers less than we ask for") +
         " in " + name + ", so they do not match: " + remedy;
}

}  // namespace bpa::wire::detail
