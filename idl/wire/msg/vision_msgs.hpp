// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/msg/geometry_msgs.hpp"

namespace bpa::wire::vision_msgs {

struct ObjectHypothesis {
  static constexpr const char* kType = "vision_msgs/msg/ObjectHypothesis";
  std::string class_id;
  double score = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("class_id", self.class_id);
    visit("score", self.score);
  }
};

struct ObjectHypothesisWithPose {
  static constexpr const char* kType = "vision_msgs/msg/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis;
  geometry_msgs::PoseWithCovariance pose;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("hypothesis", self.hypothesis);
    visit("pose", self.pose);
  }
};

struct BoundingBox3D {
  static constexpr const char* kType = "vision_msgs/msg/BoundingBox3D";
  geometry_msgs::Pose center;
  geometry_msgs::Vector3 size;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("center", self.center);
    visit("size", self.size);
  }
};

struct Detection3D {
  static constexpr const char* kType = "vision_msgs/msg/Detection3D";
  std_msgs::Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox3D bbox;
  std::string id;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("results", self.results);
    visit("bbox", self.bbox);
    visit("id", self.id);
  }
};

struct Detection3DArray {
  static constexpr const char* kType = "vision_msgs/msg/Detection3DArray";
  std_msgs::Header header;
  std::vector<Detection3D> detections;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("detections", self.detections);
  }
};

struct VisionInfo {
  static constexpr const char* kType = "vision_msgs/msg/VisionInfo";
  std_msgs::Header header;
  std::string method;
  std::string database_location;
  std::int32_t database_version = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("method", self.method);
    visit("database_location", self.database_location);
    visit("database_version", self.database_version);
  }
};

struct VisionClass {
  static constexpr const char* kType = "vision_msgs/msg/VisionClass";
  std::uint16_t class_id = 0;
  std::string class_name;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("class_id", self.class_id);
    visit("class_name", self.class_name);
  }
};

struct LabelInfo {
  static constexpr const char* kType = "vision_msgs/msg/LabelInfo";
  std_msgs::Header header;
  std::vector<VisionClass> class_map;
  float threshold = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("class_map", self.class_map);
    visit("threshold", self.threshold);
  }
};

}  // namespace bpa::wire::vision_msgs
