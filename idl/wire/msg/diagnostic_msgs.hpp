// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "idl/wire/msg/std_msgs.hpp"

namespace bpa::wire::diagnostic_msgs {

struct KeyValue {
  static constexpr const char* kType = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("key", self.key);
    visit("value", self.value);
  }
};

struct DiagnosticStatus {
  static constexpr const char* kType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::byte kOk{0}, kWarn{1}, kError{2}, kStale{3};
  std::byte level{};
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("level", self.level);
    visit("name", self.name);
    visit("message", self.message);
    visit("hardware_id", self.hardware_id);
    visit("values", self.values);
  }
};

struct DiagnosticArray {
  static constexpr const char* kType = "diagnostic_msgs/msg/DiagnosticArray";
  std_msgs::Header header;
  std::vector<DiagnosticStatus> status;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("status", self.status);
  }
};

}  // namespace bpa::wire::diagnostic_msgs
