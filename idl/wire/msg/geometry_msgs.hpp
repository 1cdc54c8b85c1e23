// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "idl/wire/msg/std_msgs.hpp"
// Lengths in metres. A pose goes from the named thing's frame to the header's.

namespace bpa::wire::geometry_msgs {

struct Point {
  static constexpr const char* kType = "geometry_msgs/msg/Point";
  double x = 0;
  double y = 0;
  double z = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
};

struct Vector3 {
  static constexpr const char* kType = "geometry_msgs/msg/Vector3";
  double x = 0;
  double y = 0;
  double z = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
};

struct Quaternion {
  static constexpr const char* kType = "geometry_msgs/msg/Quaternion";
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
    visit("w", self.w);
  }
};

struct Pose {
  static constexpr const char* kType = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
  }
};

struct PoseStamped {
  static constexpr const char* kType = "geometry_msgs/msg/PoseStamped";
  std_msgs::Header header;
  Pose pose;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
};

struct PoseWithCovariance {
  static constexpr const char* kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36>
      covariance{};  ///< Rows and columns x, y, z, rotation about X, Y, Z; m^2, rad^2.

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("pose", self.pose);
    visit("covariance", self.covariance);
  }
};

struct Transform {
  static constexpr const char* kType = "geometry_msgs/msg/Transform";
  Vector3 translation;
  Quaternion rotation;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("translation", self.translation);
    visit("rotation", self.rotation);
  }
};

struct TransformStamped {
  static constexpr const char* kType = "geometry_msgs/msg/TransformStamped";
  std_msgs::Header header;
  std::string child_frame_id;
  Transform transform;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("child_frame_id", self.child_frame_id);
    visit("transform", self.transform);
  }
};

}  // namespace bpa::wire::geometry_msgs
