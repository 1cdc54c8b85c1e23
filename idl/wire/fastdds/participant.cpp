// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/participant.hpp"

#include <memory>

#include <fastdds/dds/log/Log.hpp>

#include "idl/wire/fastdds/participant_impl.hpp"

namespace bpa::wire {
namespace {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;

class Bridge : public LogConsumer {
 public:
  explicit Bridge(LogHook hook) : hook_(std::move(hook)) {}

  void Consume(const Log::Entry& entry) override {
    const bool error = entry.kind == Log::Kind::Error;
    log(hook_, error ? LogLevel::warning : LogLevel::debug, "Fast DDS: " + entry.message);
  }

 private:
  LogHook hook_;
};

/// Takes Fast DDS's own messages, which it would print, to a hook: its errors as warnings, its
/// warnings as debug. Fast DDS has one log a process; the hook of the last participant gets it.
void bridge_log(const LogHook& hook) {
  Log::ClearConsumers();
  if (!hook) return;
  Log::SetVerbosity(Log::Kind::Warning);
  Log::RegisterConsumer(std::make_unique<Bridge>(hook));
}

}  // namespace

Participant::Participant(std::shared_ptr<detail::ParticipantImpl> impl) : impl_(std::move(impl)) {}

Result<Participant> Participant::create(ParticipantOptions options) {
  Status status = validate_full_name(options.node.full());
  if (!status.ok()) return status;
  if (options.node.name.find('/') != std::string::npos) {
    return invalid_argument("node name '" + options.node.name + "' must not have a slash");
  }
  Discovery discovery;
  if (options.discovery) {
    discovery = *options.discovery;
  } else {
    Result<Discovery> found = discovery_from_environment();
    if (!found.ok()) return found.status();
    discovery = *std::move(found);
  }
  bridge_log(options.log);
  auto impl = std::make_shared<detail::ParticipantImpl>(std::move(options), std::move(discovery));
  status = impl->start();
  if (!status.ok()) return status;
  return Participant(std::move(impl));
}

const NodeName& Participant::node() const { return impl_->options().node; }

int Participant::domain_id() const { return impl_->domain_id(); }

Result<std::string> Participant::resolve(std::string_view name) const {
  return resolve_name(name, node(), impl_->options().remaps);
}

GraphLayout Participant::graph_layout() const { return impl_->graph_layout(); }

const LogHook& detail::participant_log(const Participant& participant) {
  return participant.impl()->options().log;
}

Worker& detail::participant_worker(const Participant& participant) {
  return participant.impl()->worker();
}

}  // namespace bpa::wire
