// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "idl/wire/endpoint.hpp"

namespace bpa::wire {

/// Publishes messages of one type on one topic. Thread-safe. It leaves the topic when destroyed.
template <class T>
class Publisher {
 public:
  /// `topic` is resolved by the participant's node name and remaps.
  static Result<Publisher> create(const Participant& participant, std::string_view topic,
                                  const PublisherOptions& options = {}) {
    Result<std::string> name = participant.resolve(topic);
    if (!name.ok()) return name.status();
    auto writer = detail::make_writer(
        participant,
        detail::endpoint_spec<T>(dds_topic_name(*name), options.qos, options.shared_bytes));
    if (!writer.ok()) return writer.status();
    return Publisher(*std::move(name), std::move(writer).value());
  }

  /// Encodes straight into the memory that is sent. `Message` is T or a view of it (the same
  /// kType). `invalid_argument` when it is larger than shared_bytes, `timeout` when a reliable
  /// subscriber holds up a full history for more than 100 ms.
  template <class Message>
  Status publish(const Message& message) {
    static_assert(std::string_view(Message::kType) == T::kType, "another type than the topic's");
    return writer_->write(detail::message_ref(message), nullptr, nullptr);
  }

  /// The resolved name.
  const std::string& topic() const { return topic_; }
  /// Subscribers at present. A peer of Eclipse Cyclone that has gone counts for up to 10 s more.
  std::size_t matched_count() const { return writer_->matched_count(); }
  /// Whether `count` or more subscribers were there before the time was over.
  bool wait_for_matched(std::chrono::milliseconds timeout, std::size_t count = 1) const {
    return writer_->wait_for_matched(count, timeout);
  }

 private:
  Publisher(std::string topic, std::unique_ptr<detail::RawWriter> writer)
      : topic_(std::move(topic)), writer_(std::move(writer)) {}

  std::string topic_;
  std::unique_ptr<detail::RawWriter> writer_;
};

}  // namespace bpa::wire
