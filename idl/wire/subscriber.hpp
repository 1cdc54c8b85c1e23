// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "idl/wire/endpoint.hpp"

namespace bpa::wire {

/// Receives messages of one type on one topic. It leaves the topic when destroyed; after that the
/// callback is not running and will not run.
template <class T>
class Subscriber : public detail::TopicEnd<detail::RawReader> {
 public:
  /// Runs on a DDS thread that other subscriptions share: move the message into a bounded queue and
  /// return. It must not destroy this object. It may run before `create` returns. A message for
  /// which it throws counts as malformed.
  using Callback = std::function<void(T&&, const SampleMeta&)>;

  /// `topic` is resolved by the participant's node name and remaps.
  static Result<Subscriber> create(const Participant& participant, std::string_view topic,
                                   const SubscriberOptions& options, Callback callback) {
    Result<std::string> name = participant.resolve(topic);
    if (!name.ok()) return name.status();
    auto decode = [callback = std::move(callback)](const std::uint8_t* bytes,
                                                   std::size_t size) -> Result<detail::Deliver> {
      auto message = std::make_shared<T>();
      Status status = wire::decode(bytes, size, *message);
      if (!status.ok()) return status;
      return detail::Deliver(
          [&callback, message](const SampleMeta& meta) { callback(std::move(*message), meta); });
    };
    auto reader = detail::make_reader(participant,
                                      detail::endpoint_spec<T>(dds_topic_name(*name), options.qos),
                                      std::move(decode));
    if (!reader.ok()) return reader.status();
    return Subscriber(*std::move(name), std::move(reader).value());
  }

  ReaderStatistics statistics() const { return raw_->statistics(); }

 private:
  using detail::TopicEnd<detail::RawReader>::TopicEnd;
};

}  // namespace bpa::wire
