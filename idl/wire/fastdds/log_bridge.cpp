// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/fastdds/log_bridge.hpp"

#include <memory>

#include <fastdds/dds/log/Log.hpp>

namespace bpa::wire::detail {
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

}  // namespace

void bridge_log(const LogHook& hook) {
  Log::ClearConsumers();
  if (!hook) return;
  Log::SetVerbosity(Log::Kind::Warning);
  Log::RegisterConsumer(std::make_unique<Bridge>(hook));
}

}  // namespace bpa::wire::detail
