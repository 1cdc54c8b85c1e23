// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "idl/wire/msg/geometry_msgs.hpp"

namespace bpa::wire::tf2_msgs {

struct TFMessage {
  static constexpr const char* kType = "tf2_msgs/msg/TFMessage";
  std::vector<geometry_msgs::TransformStamped> transforms;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("transforms", self.transforms);
  }
};

}  // namespace bpa::wire::tf2_msgs
