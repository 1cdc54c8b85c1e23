// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "idl/wire/endpoint.hpp"

namespace bpa::wire {

/// Publishes messages of one type on one topic. Thread-safe. It leaves the topic when destroyed.
template <class T>
class Publisher : public detail::TopicEnd<detail::RawWriter> {
 public:
  /// `topic` is resolved by the participant's node name and remaps.
  static Result<Publisher> create(const Participant& participant, std::string_view topic,
                                  const PublisherOptions& options = {}) {
    Result<std::string> name = participant.resolve(topic);
    if (!name.ok()) return name.status();
    auto writer = detail::make_writer(participant,
                                      detail::endpoint_spec<T>(dds_topic_name(*name), options.qos));
    if (!writer.ok()) return writer.status();
    return Publisher(*std::move(name), std::move(writer).value());
  }

  /// Encodes straight into the memory that is sent. `Message` is T or a view of it (the same
  /// kType). `timeout` when a reliable subscriber holds up a full history for more than 100 ms.
  template <class Message>
  Status publish(const Message& message) {
    static_assert(std::string_view(Message::kType) == T::kType, "another type than the topic's");
    return raw_->write(detail::message_ref(message), nullptr, nullptr);
  }

 private:
  using detail::TopicEnd<detail::RawWriter>::TopicEnd;
};

}  // namespace bpa::wire
