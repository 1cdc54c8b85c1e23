// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/base/failure.hpp"
#include "core/base/log.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/publisher.hpp"

namespace bpa::server {

/// A topic of the server's own that settings may switch off.
template <class T>
class Output {
 public:
  /// An empty topic leaves it switched off. `own_readers`: subscribers of the server itself. Throws
  /// a Failure.
  void open(const wire::Participant& participant, const std::string& topic, const wire::Qos& qos,
            std::size_t own_readers = 0) {
    own_readers_ = own_readers;
    if (topic.empty()) return;
    publisher_.emplace(or_throw(wire::Publisher<T>::create(participant, topic, {.qos = qos})));
  }
  bool is_open() const { return publisher_.has_value(); }
  /// Whether another's subscriber is matched: otherwise the message need not be made.
  bool wanted() const { return publisher_ && publisher_->matched_count() > own_readers_; }
  /// Does nothing when it is switched off.
  Status publish(const T& message) { return publisher_ ? publisher_->publish(message) : Status(); }
  /// The same; a failure is logged with this severity.
  void send(const T& message, const LogHook& hook, LogLevel severity = LogLevel::warning) {
    const Status status = publish(message);
    if (!status.ok()) log(hook, severity, publisher_->topic() + ": " + status.message);
  }

 private:
  std::optional<wire::Publisher<T>> publisher_;
  std::size_t own_readers_ = 0;
};

}  // namespace bpa::server
