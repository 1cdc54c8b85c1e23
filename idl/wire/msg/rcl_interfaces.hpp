// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/field.hpp"
#include "idl/wire/msg/builtin_interfaces.hpp"

namespace bpa::wire::rcl_interfaces {

struct Log {
  static constexpr const char* kType = "rcl_interfaces/msg/Log";
  static constexpr std::uint8_t kDebug = 10, kInfo = 20, kWarn = 30, kError = 40, kFatal = 50;
  builtin_interfaces::Time stamp;
  std::uint8_t level = 0;  ///< One of the constants.
  std::string name;
  std::string msg;
  std::string file;
  std::string function;
  std::uint32_t line = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("stamp", self.stamp);
    visit("level", self.level);
    visit("name", self.name);
    visit("msg", self.msg);
    visit("file", self.file);
    visit("function", self.function);
    visit("line", self.line);
  }
};

/// What ParameterValue.type and ParameterDescriptor.type say.
namespace ParameterType {
inline constexpr std::uint8_t kNotSet = 0, kBool = 1, kInteger = 2, kDouble = 3, kString = 4;
inline constexpr std::uint8_t kByteArray = 5, kBoolArray = 6, kIntegerArray = 7;
inline constexpr std::uint8_t kDoubleArray = 8, kStringArray = 9;
}  // namespace ParameterType

struct ParameterValue {
  static constexpr const char* kType = "rcl_interfaces/msg/ParameterValue";
  std::uint8_t type = 0;  ///< One of ParameterType's constants; says which field counts.
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value;
  std::vector<std::byte> byte_array_value;
  std::vector<bool> bool_array_value;
  std::vector<std::int64_t> integer_array_value;
  std::vector<double> double_array_value;
  std::vector<std::string> string_array_value;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("type", self.type);
    visit("bool_value", self.bool_value);
    visit("integer_value", self.integer_value);
    visit("double_value", self.double_value);
    visit("string_value", self.string_value);
    visit("byte_array_value", self.byte_array_value);
    visit("bool_array_value", self.bool_array_value);
    visit("integer_array_value", self.integer_array_value);
    visit("double_array_value", self.double_array_value);
    visit("string_array_value", self.string_array_value);
  }
};

struct Parameter {
  static constexpr const char* kType = "rcl_interfaces/msg/Parameter";
  std::string name;
  ParameterValue value;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("value", self.value);
  }
};

struct FloatingPointRange {
  static constexpr const char* kType = "rcl_interfaces/msg/FloatingPointRange";
  double from_value = 0;
  double to_value = 0;
  double step = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("from_value", self.from_value);
    visit("to_value", self.to_value);
    visit("step", self.step);
  }
};

struct IntegerRange {
  static constexpr const char* kType = "rcl_interfaces/msg/IntegerRange";
  std::int64_t from_value = 0;
  std::int64_t to_value = 0;
  std::uint64_t step = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("from_value", self.from_value);
    visit("to_value", self.to_value);
    visit("step", self.step);
  }
};

struct ParameterDescriptor {
  static constexpr const char* kType = "rcl_interfaces/msg/ParameterDescriptor";
  std::string name;
  std::uint8_t type = 0;
  std::string description;
  std::string additional_constraints;
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;
  std::vector<IntegerRange> integer_range;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("name", self.name);
    visit("type", self.type);
    visit("description", self.description);
    visit("additional_constraints", self.additional_constraints);
    visit("read_only", self.read_only);
    visit("dynamic_typing", self.dynamic_typing);
    visit("floating_point_range", self.floating_point_range, Bound{1});
    visit("integer_range", self.integer_range, Bound{1});
  }
};

struct SetParametersResult {
  static constexpr const char* kType = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("successful", self.successful);
    visit("reason", self.reason);
  }
};

struct ListParametersResult {
  static constexpr const char* kType = "rcl_interfaces/msg/ListParametersResult";
  std::vector<std::string> names;
  std::vector<std::string> prefixes;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("names", self.names);
    visit("prefixes", self.prefixes);
  }
};

struct ParameterEvent {
  static constexpr const char* kType = "rcl_interfaces/msg/ParameterEvent";
  builtin_interfaces::Time stamp;
  std::string node;
  std::vector<Parameter> new_parameters;
  std::vector<Parameter> changed_parameters;
  std::vector<Parameter> deleted_parameters;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("stamp", self.stamp);
    visit("node", self.node);
    visit("new_parameters", self.new_parameters);
    visit("changed_parameters", self.changed_parameters);
    visit("deleted_parameters", self.deleted_parameters);
  }
};

struct ListParameters_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/ListParameters_Request";
  std::vector<std::string> prefixes;
  std::uint64_t depth = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("prefixes", self.prefixes);
    visit("depth", self.depth);
  }
};

struct ListParameters_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/ListParameters_Response";
  ListParametersResult result;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("result", self.result);
  }
};

struct GetParameters_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/GetParameters_Request";
  std::vector<std::string> names;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("names", self.names);
  }
};

struct GetParameters_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/GetParameters_Response";
  std::vector<ParameterValue> values;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("values", self.values);
  }
};

struct SetParameters_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/SetParameters_Request";
  std::vector<Parameter> parameters;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("parameters", self.parameters);
  }
};

struct SetParameters_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/SetParameters_Response";
  std::vector<SetParametersResult> results;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("results", self.results);
  }
};

struct SetParametersAtomically_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/SetParametersAtomically_Request";
  std::vector<Parameter> parameters;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("parameters", self.parameters);
  }
};

struct SetParametersAtomically_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/SetParametersAtomically_Response";
  SetParametersResult result;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("result", self.result);
  }
};

struct DescribeParameters_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/DescribeParameters_Request";
  std::vector<std::string> names;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("names", self.names);
  }
};

struct DescribeParameters_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/DescribeParameters_Response";
  std::vector<ParameterDescriptor> descriptors;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("descriptors", self.descriptors);
  }
};

struct GetParameterTypes_Request {
  static constexpr const char* kType = "rcl_interfaces/srv/GetParameterTypes_Request";
  std::vector<std::string> names;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("names", self.names);
  }
};

struct GetParameterTypes_Response {
  static constexpr const char* kType = "rcl_interfaces/srv/GetParameterTypes_Response";
  std::vector<std::uint8_t> types;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("types", self.types);
  }
};

struct ListParameters {
  using Request = ListParameters_Request;
  using Response = ListParameters_Response;
};

struct GetParameters {
  using Request = GetParameters_Request;
  using Response = GetParameters_Response;
};

struct SetParameters {
  using Request = SetParameters_Request;
  using Response = SetParameters_Response;
};

struct SetParametersAtomically {
  using Request = SetParametersAtomically_Request;
  using Response = SetParametersAtomically_Response;
};

struct DescribeParameters {
  using Request = DescribeParameters_Request;
  using Response = DescribeParameters_Response;
};

struct GetParameterTypes {
  using Request = GetParameterTypes_Request;
  using Response = GetParameterTypes_Response;
};

}  // namespace bpa::wire::rcl_interfaces
