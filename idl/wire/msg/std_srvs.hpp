// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "idl/wire/field.hpp"

namespace bpa::wire::std_srvs {

struct Trigger_Request {
  static constexpr const char* kType = "std_srvs/srv/Trigger_Request";
  std::uint8_t structure_needs_at_least_one_member = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit(kEmptyStructField, self.structure_needs_at_least_one_member);
  }
};

struct Trigger_Response {
  static constexpr const char* kType = "std_srvs/srv/Trigger_Response";
  bool success = false;
  std::string message;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("success", self.success);
    visit("message", self.message);
  }
};

struct Trigger {
  using Request = Trigger_Request;
  using Response = Trigger_Response;
};
}  // namespace bpa::wire::std_srvs
