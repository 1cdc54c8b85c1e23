// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/msg/geometry_msgs.hpp"
#include "idl/wire/msg/sensor_msgs.hpp"

namespace bpa::wire::visualization_msgs {

struct UVCoordinate {
  static constexpr const char* kType = "visualization_msgs/msg/UVCoordinate";
  float u = 0;
  float v = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("u", self.u);
    visit("v", self.v);
  }
};

struct MeshFile {
  static constexpr const char* kType = "visualization_msgs/msg/MeshFile";
  std::string filename;
  std::vector<std::uint8_t> data;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("filename", self.filename);
    visit("data", self.data);
  }
};

struct Marker {
  static constexpr const char* kType = "visualization_msgs/msg/Marker";
  static constexpr std::int32_t kArrow = 0, kCube = 1, kSphere = 2, kCylinder = 3;
  static constexpr std::int32_t kLineStrip = 4, kLineList = 5, kCubeList = 6, kSphereList = 7;
  static constexpr std::int32_t kPoints = 8, kText = 9, kMesh = 10, kTriangleList = 11;
  static constexpr std::int32_t kAdd = 0, kDelete = 2, kDeleteAll = 3;
  std_msgs::Header header;
  std::string ns;
  std::int32_t id = 0;
  std::int32_t type = 0;    ///< kArrow to kTriangleList.
  std::int32_t action = 0;  ///< kAdd, kDelete or kDeleteAll.
  geometry_msgs::Pose pose;
  geometry_msgs::Vector3 scale;
  std_msgs::ColorRGBA color;
  builtin_interfaces::Duration lifetime;  ///< 0: for ever.
  bool frame_locked = false;
  std::vector<geometry_msgs::Point> points;
  std::vector<std_msgs::ColorRGBA> colors;
  std::string texture_resource;
  sensor_msgs::CompressedImage texture;
  std::vector<UVCoordinate> uv_coordinates;
  std::string text;
  std::string mesh_resource;
  MeshFile mesh_file;
  bool mesh_use_embedded_materials = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("ns", self.ns);
    visit("id", self.id);
    visit("type", self.type);
    visit("action", self.action);
    visit("pose", self.pose);
    visit("scale", self.scale);
    visit("color", self.color);
    visit("lifetime", self.lifetime);
    visit("frame_locked", self.frame_locked);
    visit("points", self.points);
    visit("colors", self.colors);
    visit("texture_resource", self.texture_resource);
    visit("texture", self.texture);
    visit("uv_coordinates", self.uv_coordinates);
    visit("text", self.text);
    visit("mesh_resource", self.mesh_resource);
    visit("mesh_file", self.mesh_file);
    visit("mesh_use_embedded_materials", self.mesh_use_embedded_materials);
  }
};

struct MarkerArray {
  static constexpr const char* kType = "visualization_msgs/msg/MarkerArray";
  std::vector<Marker> markers;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("markers", self.markers);
  }
};

}  // namespace bpa::wire::visualization_msgs
