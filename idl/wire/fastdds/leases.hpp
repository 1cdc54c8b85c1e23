// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "idl/wire/fastdds/version.hpp"
#include "idl/wire/private/announcements.hpp"
#include "idl/wire/task_thread.hpp"

#if BPA_FASTDDS_MAJOR >= 3
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#else
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#endif

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

/// Looks at the leases of peers in place of Fast DDS 2.9.1 and 3.1.2, which may not survive a look
/// while a peer leaves. PDP::check_remote_participant_liveliness waits for the mutex of the PDP in
/// the event thread.
/// - When it gets the mutex, PDP::remove_remote_participant may have cleared the peer's proxy. Its
///   assert on m_guid then ends the process. Debian compiles asserts in.
/// - PDP::removeWriterProxyData may hold the mutex and wait for the event thread, in
///   WriterProxy::stop, TimedEvent::recreate_timer and ResourceEvent::unregister_timer. Both wait
///   for ever.
/// So announcements that come in get a lease without an end. A peer that is silent for the lease
/// that it announced is said to leave, as if it had said so itself.
class Leases {
 public:
  using Receiver = eprosima::fastdds::rtps::TransportReceiverInterface;
  /// A packet, and where it goes.
  struct Packet {
    const rtps::octet* data = nullptr;
    std::uint32_t size = 0;
    Receiver* receiver = nullptr;
    rtps::Locator_t local, remote;
  };

  explicit Leases(TaskThread& tasks) : tasks_(tasks) {}

  /// Notes the packet's sender. True when `changed` is what goes on in place of the packet.
  bool note(const Packet& packet, std::vector<rtps::octet>& changed);
  /// Before the participant is deleted. Receivers are not used any more when it returns.
  void close();

 private:
  using Clock = TaskThread::Clock;
  struct Peer {
    Clock::time_point heard;
    Clock::duration lease{};
    Receiver* receiver = nullptr;  ///< Of its announcements.
    rtps::Locator_t local, remote;
    std::uint32_t announcement = 0;  ///< The number of the last.
  };

  /// Schedules the next look at all leases, as one task for all peers. The caller holds mutex_.
  void look_later();
  void look();

  TaskThread& tasks_;
  std::mutex leaving_mutex_;  // held while a peer is said to leave; before the other
  std::mutex mutex_;
  bool closed_ = false;
  bool looks_ = false;  // a look is due
  std::map<GuidPrefix, Peer> peers_;
};

/// The transport of `udp`, whose packets `leases` notes.
eprosima::fastdds::rtps::TransportInterface* transport_with_leases(
    const eprosima::fastdds::rtps::UDPv4TransportDescriptor& udp, std::shared_ptr<Leases> leases);

}  // namespace bpa::wire::detail
