// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace YAML {
class Node;
}

namespace bpa::io {

/// The first document of a text. Aliases (*name) are refused, as ROS 2 refuses them: a few lines of
/// them stand for a tree without end. Throws a YAML::Exception.
YAML::Node parse_yaml(const std::string& text);

}  // namespace bpa::io
