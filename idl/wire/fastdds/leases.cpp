// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/fastdds/leases.hpp"

#include <algorithm>
#include <iterator>

namespace bpa::wire::detail {

namespace {

using Byte = rtps::octet;

/// From one look at all leases to the next, and the shortest lease: a peer says how long it is.
constexpr std::chrono::milliseconds kBetweenLooks{100};
/// Beyond, Fast DDS looks at the lease.
constexpr std::size_t kMaxWatched = 4096;

}  // namespace

bool Leases::note(const Packet& packet, std::vector<Byte>& changed) {
  if (packet.size < kGuidPrefixAt + GuidPrefix().size()) return false;
  GuidPrefix prefix;
  std::copy_n(packet.data + kGuidPrefixAt, prefix.size(), prefix.begin());
  const auto announcements = announcements_in(packet.data, packet.size);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (closed_) return false;
  const auto known = peers_.find(prefix);
  if (known != peers_.end()) known->second.heard = Clock::now();
  for (const Announcement& said : announcements) {
    if (said.leaves || said.lease_at == 0 || said.lease >= std::chrono::seconds(kEndlessLease)) {
      peers_.erase(prefix);
      continue;
    }
    if (peers_.size() >= kMaxWatched && peers_.count(prefix) == 0) continue;
    peers_[prefix] = {Clock::now(),    std::max<Clock::duration>(said.lease, kBetweenLooks),
                      packet.receiver, packet.local,
                      packet.remote,   said.number};
    look_later();
    if (changed.empty()) changed.assign(packet.data, packet.data + packet.size);
    make_lease_endless(changed.data(), said);
  }
  return !changed.empty();
}

void Leases::close() {
  const std::lock_guard<std::mutex> leaving(leaving_mutex_);
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  peers_.clear();
}

void Leases::look_later() {
  if (looks_ || peers_.empty()) return;
  looks_ = true;
  tasks_.run_at(Clock::now() + kBetweenLooks, [this] { look(); });
}

void Leases::look() {
  const std::lock_guard<std::mutex> leaving(leaving_mutex_);
  std::unique_lock<std::mutex> lock(mutex_);
  std::map<GuidPrefix, Peer> silent;
  for (auto peer = peers_.begin(); peer != peers_.end();) {
    const auto next = std::next(peer);
    if (Clock::now() > peer->second.heard + peer->second.lease) silent.insert(peers_.extract(peer));
    peer = next;
  }
  looks_ = false;
  look_later();
  lock.unlock();  // what follows waits for threads that receive
  for (const auto& [prefix, peer] : silent) {
    const std::vector<Byte> bytes = departure(prefix, peer.announcement + 1);
    peer.receiver->OnDataReceived(bytes.data(), static_cast<std::uint32_t>(bytes.size()),
                                  peer.local, peer.remote);
  }
}

namespace {

using namespace eprosima::fastdds::rtps;  // which has other names in the two generations

class LeaseTransport : public ChainingTransport {
 public:
  LeaseTransport(const UDPv4TransportDescriptor& udp, std::shared_ptr<Leases> leases)
      : ChainingTransport(Descriptor(std::make_shared<UDPv4TransportDescriptor>(udp))),
        leases_(std::move(leases)) {}

  // What is sent takes the way that it takes without this.
  bool OpenOutputChannel(SendResourceList& senders, const rtps::Locator_t& locator) override {
    return low_level_transport_->OpenOutputChannel(senders, locator);
  }
  TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
#if BPA_FASTDDS_MAJOR >= 3
  bool send(rtps::SenderResource* sender, const std::vector<NetworkBuffer>& buffers,
            std::uint32_t size, rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& until) override {
    return sender->send(buffers, size, begin, end, until);
  }
#else
  bool send(rtps::SenderResource* sender, const Byte* data, std::uint32_t size,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& until) override {
    return sender->send(data, size, begin, end, until);
  }
#endif
  void receive(TransportReceiverInterface* next, const Byte* data, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    std::vector<Byte> changed;
    if (leases_->note({data, size, next, local, remote}, changed)) data = changed.data();
    next->OnDataReceived(data, size, local, remote);
  }

 private:
  struct Descriptor : ChainingTransportDescriptor {
    using ChainingTransportDescriptor::ChainingTransportDescriptor;
    TransportInterface* create_transport() const override { return nullptr; }
  };

  const std::shared_ptr<Leases> leases_;
};

}  // namespace

TransportInterface* transport_with_leases(const UDPv4TransportDescriptor& udp,
                                          std::shared_ptr<Leases> leases) {
  return new LeaseTransport(udp, std::move(leases));
}

}  // namespace bpa::wire::detail
