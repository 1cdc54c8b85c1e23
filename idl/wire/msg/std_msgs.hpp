// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "idl/wire/msg/builtin_interfaces.hpp"

namespace bpa::wire::std_msgs {

struct Header {
  static constexpr const char* kType = "std_msgs/msg/Header";
  builtin_interfaces::Time stamp;  ///< When the data was sensed.
  std::string frame_id;            ///< The coordinate frame of the data.

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("stamp", self.stamp);
    visit("frame_id", self.frame_id);
  }
};

struct ColorRGBA {
  static constexpr const char* kType = "std_msgs/msg/ColorRGBA";
  float r = 0;
  float g = 0;
  float b = 0;
  float a = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("r", self.r);
    visit("g", self.g);
    visit("b", self.b);
    visit("a", self.a);
  }
};

struct String {
  static constexpr const char* kType = "std_msgs/msg/String";
  std::string data;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("data", self.data);
  }
};

}  // namespace bpa::wire::std_msgs
