// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/msg/std_msgs.hpp"

namespace bpa::wire::sensor_msgs {

struct RegionOfInterest {
  static constexpr const char* kType = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("x_offset", self.x_offset);
    visit("y_offset", self.y_offset);
    visit("height", self.height);
    visit("width", self.width);
    visit("do_rectify", self.do_rectify);
  }
};

struct Image {
  static constexpr const char* kType = "sensor_msgs/msg/Image";
  std_msgs::Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;  ///< Such as "rgb8", "16UC1" (depth in mm), "32FC1" (depth in m).
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;          ///< Bytes of a row.
  std::vector<std::uint8_t> data;  ///< step * height bytes.

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("encoding", self.encoding);
    visit("is_bigendian", self.is_bigendian);
    visit("step", self.step);
    visit("data", self.data);
  }
};

struct CompressedImage {
  static constexpr const char* kType = "sensor_msgs/msg/CompressedImage";
  std_msgs::Header header;
  std::string format;  ///< Such as "jpeg", "png", "16UC1; compressedDepth png".
  std::vector<std::uint8_t> data;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("format", self.format);
    visit("data", self.data);
  }
};

struct CameraInfo {
  static constexpr const char* kType = "sensor_msgs/msg/CameraInfo";
  std_msgs::Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};
  std::array<double, 9> r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("distortion_model", self.distortion_model);
    visit("d", self.d);
    visit("k", self.k);
    visit("r", self.r);
    visit("p", self.p);
    visit("binning_x", self.binning_x);
    visit("binning_y", self.binning_y);
    visit("roi", self.roi);
  }
};

struct PointField {
  static constexpr const char* kType = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t kInt8 = 1, kUint8 = 2, kInt16 = 3, kUint16 = 4, kInt32 = 5;
  static constexpr std::uint8_t kUint32 = 6, kFloat32 = 7, kFloat64 = 8;
  std::string name;
  std::uint32_t offset = 0;   ///< Bytes from the start of a point.
  std::uint8_t datatype = 0;  ///< One of the constants.
  std::uint32_t count = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("offset", self.offset);
    visit("datatype", self.datatype);
    visit("count", self.count);
  }
};

struct PointCloud2 {
  static constexpr const char* kType = "sensor_msgs/msg/PointCloud2";
  std_msgs::Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> point_fields;  ///< "fields" in ROS.
  bool is_bigendian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::vector<std::uint8_t> data;
  bool is_dense = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("fields", self.point_fields);
    visit("is_bigendian", self.is_bigendian);
    visit("point_step", self.point_step);
    visit("row_step", self.row_step);
    visit("data", self.data);
    visit("is_dense", self.is_dense);
  }
};

}  // namespace bpa::wire::sensor_msgs
