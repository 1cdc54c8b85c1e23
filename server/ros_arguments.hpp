// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "server/options.hpp"

// The part of a command line that every ROS 2 node understands, as `ros2 run` and launch files use
// it: --ros-args -r FROM:=TO -r __node:=NAME -r __ns:=NAMESPACE -p NAME:=VALUE --params-file FILE
// --log-level LEVEL --enclave NAME, until `--` or the end.

namespace bpa::server {

struct RosArguments {
  std::vector<std::string> own;         ///< What is not for ROS; the program's name comes first.
  std::vector<std::string> remaps;      ///< from:=to, __node:=x and __ns:=/y included.
  std::vector<std::string> parameters;  ///< name:=value
  std::vector<std::string> files;       ///< Parameter files.
  std::string log_level;                ///< Empty: none given.
  std::string enclave;                  ///< Likewise.
};

/// Takes a command line apart. `invalid_argument` for what ROS would not understand.
Result<RosArguments> take_ros_arguments(const std::vector<std::string>& command_line);

/// Sets what they say, files first, as ROS does. Parameters are the settings, "group.key"; in a
/// file they stand under the node's name (or /**) and ros__parameters. A parameter that does not
/// exist is an error.
Status apply(const RosArguments& arguments, ServerOptions& options);

}  // namespace bpa::server
