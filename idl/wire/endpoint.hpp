// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/names.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/qos.hpp"

// Writers and readers of bytes, below the typed publishers, subscribers and services: use those.

namespace bpa::wire {

/// A DDS GUID: 12 bytes of participant prefix, 4 of entity id. All zero: unknown.
using Guid = std::array<std::uint8_t, 16>;

/// The participant of an endpoint: the same GUID with entity 0.
Guid participant_of(Guid guid);
/// Of a participant of this process; entity 0.
Guid guid_of(const Participant& participant);
/// A participant's id as Fast DDS prints it: "01.0f.22.cd....". The entity is left out.
std::string to_text(const Guid& guid);

/// Identifies a sample: its writer, and its place in the order of that writer.
struct SampleId {
  Guid writer{};
  std::int64_t sequence = 0;
};

/// What comes with a sample.
struct SampleMeta {
  SampleId id;
  SampleId related;                 ///< Of a request or reply; zero when absent.
  std::int64_t source_time_ns = 0;  ///< When it was written, by the writer's clock (UTC).
};

/// How many samples a subscriber or service has got.
struct ReaderStatistics {
  std::uint64_t received = 0;   ///< Delivered to the callback.
  std::uint64_t malformed = 0;  ///< Refused: no legal encoding of the type, or handling it failed.
  std::uint64_t lost = 0;       ///< Reported lost or rejected by DDS.
  /// Publishers that did not match because their QoS offers less than was asked for.
  std::uint64_t incompatible = 0;
};

struct PublisherOptions {
  Qos qos = qos::results();
};

struct SubscriberOptions {
  Qos qos = qos::sensor_input();
};

class TaskThread;

namespace detail {

/// A message to be written, its type forgotten.
struct MessageRef {
  const void* message;
  std::size_t (*encoded_size)(const void*);
  std::size_t (*encode)(const void*, std::uint8_t* to, std::size_t capacity);
};

template <class T>
MessageRef message_ref(const T& message) {
  return {&message, [](const void* m) { return encoded_size(*static_cast<const T*>(m)); },
          [](const void* m, std::uint8_t* to, std::size_t capacity) {
            return encode(*static_cast<const T*>(m), to, capacity);
          }};
}

/// A message that is encoded already.
MessageRef bytes_ref(const std::vector<std::uint8_t>& bytes);

/// What an endpoint is, in DDS's names.
struct EndpointSpec {
  std::string dds_topic;
  std::string dds_type;
  std::string user_data;  ///< Such as "typehash=RIHS01_...;".
  Qos qos;
  bool in_graph = true;  ///< Listed in ros_discovery_info.
};

template <class T>
EndpointSpec endpoint_spec(std::string dds_topic, const Qos& qos) {
  return {std::move(dds_topic), dds_type_name(T::kType), concat("typehash=", T::kTypeHash, ";"),
          qos};
}

/// The remote endpoints that one of ours is matched with.
class Matches {
 public:
  /// Adds a peer if `change`, DDS's change of the number of matches, is positive, else removes it.
  void update(const Guid& peer, int change);
  std::size_t count() const;
  std::set<Guid> peers() const;
  /// Whether any of these is still matched.
  bool contains_any(const std::set<Guid>& peers) const;
  /// Whether there are `count` of them or more, or were before the time was over.
  bool wait_for(std::size_t count, std::chrono::milliseconds timeout) const;
  /// An entity id of zero stands for any endpoint of that participant.
  bool contains(const Guid& peer) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::set<Guid> peers_;
};

/// What writers and readers have in common. They leave their topic when destroyed.
class RawEndpoint {
 public:
  virtual ~RawEndpoint() = default;
  virtual Guid guid() const = 0;
  const Matches& matches() const { return matches_; }

 protected:
  Matches matches_;
};

class RawWriter : public RawEndpoint {
 public:
  /// `related` may be null; `written`, if not null, gets the sample's id.
  virtual Status write(const MessageRef& message, const SampleId* related, SampleId* written) = 0;
  /// Until all reliable readers have what was written, or the time is over.
  virtual void wait_until_received(std::chrono::milliseconds timeout) = 0;
};

class RawReader : public RawEndpoint {
 public:
  virtual ReaderStatistics statistics() const = 0;
};

/// The end of a topic as users see it: what publishers and subscribers have in common.
template <class Raw>
class TopicEnd {
 public:
  /// The resolved name.
  const std::string& topic() const { return topic_; }
  /// Peers at present: subscribers of a publisher, publishers of a subscriber. A peer of Eclipse
  /// Cyclone that has gone counts for up to 10 s more.
  std::size_t matched_count() const { return raw_->matches().count(); }
  /// Whether `count` or more peers were there before the time was over.
  bool wait_for_matched(std::chrono::milliseconds timeout, std::size_t count = 1) const {
    return raw_->matches().wait_for(count, timeout);
  }

 protected:
  TopicEnd(std::string topic, std::unique_ptr<Raw> raw)
      : topic_(std::move(topic)), raw_(std::move(raw)) {}

  std::string topic_;
  std::unique_ptr<Raw> raw_;
};

/// What to do with a sample that was decoded, once DDS says that it was whole.
using Deliver = std::function<void(const SampleMeta&)>;
/// Decodes a sample's bytes where they lie; a failure counts it as malformed. This and what it
/// gives back run on a DDS thread.
using RawDecode = std::function<Result<Deliver>(const std::uint8_t*, std::size_t)>;

/// Copies the bytes, for samples that cannot be decoded before their SampleMeta is known.
RawDecode copy_bytes(std::function<void(std::vector<std::uint8_t>&&, const SampleMeta&)> callback);

/// Counts what peers can cause at will, each participant by itself, and says what of it to log.
class PeerCounts {
 public:
  /// Counts one event of `peer`. Of those of its participant, the 1st, 2nd, 4th, 8th ... give their
  /// number; the others 0.
  std::uint64_t add(const Guid& peer);

 private:
  std::mutex mutex_;
  std::map<Guid, std::uint64_t> counts_;  ///< By participant; begins anew with too many.
};

/// What services need of their participant.
const LogHook& participant_log(const Participant& participant);
TaskThread& participant_tasks(const Participant& participant);

Result<std::unique_ptr<RawWriter>> make_writer(const Participant& participant, EndpointSpec spec);
Result<std::unique_ptr<RawReader>> make_reader(const Participant& participant, EndpointSpec spec,
                                               RawDecode decode);

/// A topic as its publishers announced it: the type of one of them, the QoS that all offer. None
/// without a publisher. A subscriber that takes it matches them all.
std::optional<EndpointSpec> find_published(const Participant& participant,
                                           const std::string& dds_topic);

}  // namespace detail
}  // namespace bpa::wire
