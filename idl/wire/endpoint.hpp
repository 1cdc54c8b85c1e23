// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "idl/wire/cdr.hpp"
#include "idl/wire/names.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/qos.hpp"

// Writers and readers of bytes, on which the typed publishers, subscribers and services are built.
// Use those.

namespace bpa::wire {

/// A DDS GUID: 12 bytes of participant prefix, 4 of entity id. All zero: unknown.
using Guid = std::array<std::uint8_t, 16>;

/// Which sample: who wrote it and the how-manieth of that writer it is.
struct SampleId {
  Guid writer{};
  std::int64_t sequence = 0;
};

/// What comes with a sample.
struct SampleMeta {
  SampleId id;
  SampleId related;                  ///< Of a request or reply; zero when absent.
  std::int64_t source_time_ns = 0;   ///< When it was written, by the writer's clock (UTC).
  std::int64_t receive_time_ns = 0;  ///< When it arrived, by this machine's clock (UTC).
};

/// How many samples a subscriber or service has seen.
struct ReaderStatistics {
  std::uint64_t received = 0;   ///< Delivered to the callback.
  std::uint64_t malformed = 0;  ///< Refused: not a legal encoding of the type.
  std::uint64_t lost = 0;       ///< Reported lost or rejected by DDS.
};

struct PublisherOptions {
  Qos qos = qos::results();
  /// > 0: samples of up to so many bytes go through memory shared with subscribers of this project
  /// on the same machine (others get them over UDP); larger ones are refused. 0: UDP only, as it is
  /// when /dev/shm has less room than qos.depth + 1 such samples, which is logged.
  std::size_t shared_bytes = 0;
};

struct SubscriberOptions {
  Qos qos = qos::sensor_input();
  /// > 0: takes part in data sharing; samples of more bytes are refused, over UDP as well.
  std::size_t shared_bytes = 0;
};

/// Holds a bpa_msgs/RgbdFrame of 1920 x 1080 with colour, 32FC1 depth and mask, or less.
inline constexpr std::size_t kFrameBytes = 24U << 20U;

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
  std::size_t shared_bytes = 0;
  bool in_graph = true;  ///< Listed in ros_discovery_info.
};

template <class T>
EndpointSpec endpoint_spec(std::string dds_topic, const Qos& qos, std::size_t shared_bytes) {
  return {std::move(dds_topic), dds_type_name(T::kType),
          std::string("typehash=") + T::kTypeHash + ";", qos, shared_bytes};
}

class RawWriter {
 public:
  virtual ~RawWriter() = default;
  /// `related` may be null; `written`, if not null, gets the sample's id.
  virtual Status write(const MessageRef& message, const SampleId* related, SampleId* written) = 0;
  virtual std::size_t matched_count() const = 0;
  virtual bool wait_for_matched(std::size_t count, std::chrono::milliseconds timeout) const = 0;
  virtual Guid guid() const = 0;
  /// An entity id of zero stands for any reader of that participant.
  virtual bool is_matched_with(const Guid& reader) const = 0;
};

class RawReader {
 public:
  virtual ~RawReader() = default;
  virtual std::size_t matched_count() const = 0;
  virtual bool wait_for_matched(std::size_t count, std::chrono::milliseconds timeout) const = 0;
  virtual Guid guid() const = 0;
  virtual ReaderStatistics statistics() const = 0;
};

/// Gets a sample's bytes where they lie and gives back what to do once DDS says that the sample was
/// whole; a failure counts it as malformed. Both run on a DDS thread.
using RawDecode =
    std::function<Result<std::function<void(const SampleMeta&)>>(const std::uint8_t*, std::size_t)>;

class Worker;

/// Of events that a peer can cause at will, the 1st, 2nd, 4th, 8th ... are logged.
inline bool is_power_of_two(std::uint64_t count) { return (count & (count - 1)) == 0; }

/// What services need of their participant.
const LogHook& participant_log(const Participant& participant);
Worker& participant_worker(const Participant& participant);

Result<std::unique_ptr<RawWriter>> make_writer(const Participant& participant, EndpointSpec spec);
Result<std::unique_ptr<RawReader>> make_reader(const Participant& participant, EndpointSpec spec,
                                               RawDecode decode);

}  // namespace detail
}  // namespace bpa::wire
