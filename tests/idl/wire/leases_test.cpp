// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/idl/wire/domain.hpp"

// Peers that leave, or fall silent, about the end of their lease. They are no more than the packets
// of RTPS (formal/22-04-01) that say so.

namespace bpa::wire {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr int kDepartures = 400;  // without Leases, Fast DDS ends the process within 100, often

class Packet {
 public:
  template <class... Byte>
  void bytes(Byte... values) {
    (bytes_.push_back(static_cast<std::uint8_t>(values)), ...);
  }
  void u16(std::size_t v) { bytes(v, v >> 8); }
  void u32(std::size_t v) { bytes(v, v >> 8, v >> 16, v >> 24); }
  void parameter(std::size_t id, const Packet& value) {
    u16(id);
    u16(value.bytes_.size());
    append(value);
  }
  void append(const Packet& other) {
    bytes_.insert(bytes_.end(), other.bytes_.begin(), other.bytes_.end());
  }
  const std::vector<std::uint8_t>& all() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

Packet word(std::size_t value) {
  Packet packet;
  packet.u32(value);
  return packet;
}

sockaddr_in local(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// Has all endpoints of discovery, and never answers.
class Peer {
 public:
  Peer(int domain, microseconds lease)
      : there_(local(7400 + 250 * domain + 10)),
        lease_(lease),
        socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    auto address = local(0);
    auto* any = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(socket_, any, size), 0);
    EXPECT_EQ(getsockname(socket_, any, &size), 0);
    port_ = ntohs(address.sin_port);
    const timeval wait{0, 100'000};
    EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof(wait)), 0);
    static std::uint32_t peers = 0;
    name_.bytes(1, 15, 9, 9, getpid(), getpid() >> 8, 0, 0);
    name_.u32(++peers);
  }
  ~Peer() { close(socket_); }
  Peer(const Peer&) = delete;

  void come() {
    Packet says, endpoints = word(0xc3f), lease = word(lease_.count() / 1'000'000), version, vendor;
    lease.u32((lease_.count() % 1'000'000 << 32) / 1'000'000);
    version.bytes(2, 3, 0, 0);
    vendor.bytes(1, 15, 0, 0);
    says.bytes(0, 3, 0, 0);  // PL_CDR_LE
    says.parameter(0x15, version);
    says.parameter(0x16, vendor);
    says.parameter(0x50, guid());
    says.parameter(0x32, locator());
    says.parameter(0x31, locator());
    says.parameter(0x02, lease);
    says.parameter(0x58, endpoints);
    says.parameter(0x01, {});
    announce(1, 5, says);
  }
  void say_something() { send({}); }
  void leave() {
    Packet says, status;
    status.bytes(0, 0, 0, 3);  // disposed and unregistered
    says.parameter(0x70, guid());
    says.parameter(0x71, status);
    says.parameter(0x01, {});
    announce(2, 3, says);
  }

  bool hears_something(milliseconds time) {
    for (const auto end = Clock::now() + time; Clock::now() < end;) {
      if (recv(socket_, buffer_.data(), buffer_.size(), 0) > 0) return true;
    }
    return false;
  }
  void forget_what_came() {
    while (recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT) > 0) continue;
  }

 private:
  Packet guid() const {
    Packet guid = name_;
    guid.bytes(0, 0, 1, 0xc1);
    return guid;
  }
  Packet locator() const {
    Packet locator = word(1);  // UDPv4
    locator.u32(port_);
    locator.bytes(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1);
    return locator;
  }
  void announce(std::size_t number, int flags, const Packet& content) {
    Packet data;
    data.bytes(0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0);
    data.u32(number);
    data.append(content);
    Packet message;
    message.bytes(0x15, flags);
    message.u16(data.all().size());
    message.append(data);
    send(message);
  }
  void send(const Packet& message) {
    Packet packet;
    packet.bytes('R', 'T', 'P', 'S', 2, 3, 1, 15);
    packet.append(name_);
    packet.append(message);
    const auto* there = reinterpret_cast<const sockaddr*>(&there_);
    sendto(socket_, packet.all().data(), packet.all().size(), 0, there, sizeof(there_));
  }

  const sockaddr_in there_;
  const microseconds lease_;
  const int socket_;
  std::size_t port_ = 0;
  Packet name_;
  std::array<std::uint8_t, 65536> buffer_{};
};

class Leases : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(participant.ok()) << participant.status().message; }
  const Result<Participant> participant = test_participant("stays");
};

// Here the lease is looked at all the time, so that the peer leaves while it is.
TEST_F(Leases, PeersMayLeaveWhileTheirLeaseIsLookedAt) {
  std::minstd_rand random(1);
  for (int i = 0; i < kDepartures; ++i) {
    Peer peer(participant->domain_id(), milliseconds(1));
    peer.come();
    const auto end = Clock::now() + microseconds(2000 + random() % 2000);
    while (Clock::now() < end) {
      std::this_thread::sleep_for(microseconds(100));
      peer.say_something();
    }
    peer.leave();
  }
  Peer last(participant->domain_id(), std::chrono::seconds(5));
  last.come();
  EXPECT_TRUE(last.hears_something(milliseconds(5000)));
}

// Discovery repeats to a peer what it did not say it has, until the peer is forgotten.
TEST_F(Leases, SilentPeersAreForgottenOthersAreNot) {
  Peer peer(participant->domain_id(), milliseconds(1000));
  peer.come();
  for (int i = 0; i < 15; ++i) {
    std::this_thread::sleep_for(milliseconds(100));
    peer.say_something();
  }
  peer.forget_what_came();
  EXPECT_TRUE(peer.hears_something(milliseconds(900)));
  std::this_thread::sleep_for(milliseconds(1500));
  peer.forget_what_came();
  EXPECT_FALSE(peer.hears_something(milliseconds(1200)));
  peer.come();  // the network was away, and the peer was not
  EXPECT_TRUE(peer.hears_something(milliseconds(900)));
}

}  // namespace
}  // namespace bpa::wire
