// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "idl/wire/endpoint.hpp"

// What ros_discovery_info says of this participant: its one node and that node's readers and
// writers. Always the complete state, in one message.

namespace bpa::wire::detail {

inline constexpr const char* kGraphTopic = "ros_discovery_info";

/// The state, encoded with ids of 16 bytes (iron16) or 24 (humble24).
std::vector<std::uint8_t> encode_graph(GraphLayout layout, const Guid& participant,
                                       const NodeName& node, const std::set<Guid>& readers,
                                       const std::set<Guid>& writers);

/// Guesses the layout from the graph endpoints of others: those of Iron and later announce a type
/// hash, Humble's do not. This project's own do, and are no evidence.
class GraphLayoutGuess {
 public:
  void discovered(const Guid& endpoint, std::string_view user_data);
  void removed(const Guid& endpoint);
  GraphLayout layout() const;

 private:
  std::map<Guid, bool> has_hash_;
};

/// Marks the graph endpoints of this project in their user data.
inline constexpr const char* kOwnMark = "bpa=1;";

}  // namespace bpa::wire::detail
