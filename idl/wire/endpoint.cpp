// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/endpoint.hpp"

#include <algorithm>
#include <cstring>

namespace bpa::wire {

namespace {
constexpr std::size_t kPrefixSize = 12;  // of a GUID: the participant
}  // namespace

Guid participant_of(Guid guid) {
  std::fill(guid.begin() + kPrefixSize, guid.end(), std::uint8_t{0});
  return guid;
}

std::string to_text(const Guid& guid) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < kPrefixSize; ++i) {
    if (i > 0) text += '.';
    text += {kDigits[guid[i] >> 4U], kDigits[guid[i] & 15U]};
  }
  return text;
}

namespace detail {

std::uint64_t PeerCounts::add(const Guid& peer) {
  constexpr std::size_t kMaxCounted = 1024;
  const std::lock_guard<std::mutex> lock(mutex_);
  const Guid participant = participant_of(peer);
  if (counts_.size() >= kMaxCounted && counts_.count(participant) == 0) counts_.clear();
  const std::uint64_t count = ++counts_[participant];
  return (count & (count - 1)) == 0 ? count : 0;
}

void Matches::update(const Guid& peer, int change) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (change > 0) peers_.insert(peer);
  if (change < 0) peers_.erase(peer);
  changed_.notify_all();
}

std::size_t Matches::count() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return peers_.size();
}

std::set<Guid> Matches::peers() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return peers_;
}

bool Matches::contains_any(const std::set<Guid>& peers) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(peers.begin(), peers.end(),
                     [this](const Guid& peer) { return peers_.count(peer) != 0; });
}

bool Matches::wait_for(std::size_t count, std::chrono::milliseconds timeout) const {
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] { return peers_.size() >= count; });
}

bool Matches::contains(const Guid& peer) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (peer != participant_of(peer)) return peers_.count(peer) != 0;
  return std::any_of(peers_.begin(), peers_.end(),
                     [&peer](const Guid& guid) { return participant_of(guid) == peer; });
}

MessageRef bytes_ref(const std::vector<std::uint8_t>& bytes) {
  using Bytes = std::vector<std::uint8_t>;
  return {&bytes, [](const void* message) { return static_cast<const Bytes*>(message)->size(); },
          [](const void* message, std::uint8_t* to, std::size_t capacity) -> std::size_t {
            const Bytes& from = *static_cast<const Bytes*>(message);
            if (from.empty() || from.size() > capacity) return 0;
            std::memcpy(to, from.data(), from.size());
            return from.size();
          }};
}

RawDecode copy_bytes(std::function<void(std::vector<std::uint8_t>&&, const SampleMeta&)> callback) {
  return [callback = std::move(callback)](const std::uint8_t* bytes,
                                          std::size_t size) -> Result<Deliver> {
    auto copy = std::make_shared<std::vector<std::uint8_t>>(bytes, bytes + size);
    return Deliver([&callback, copy](const SampleMeta& meta) { callback(std::move(*copy), meta); });
  };
}

}  // namespace detail
}  // namespace bpa::wire
