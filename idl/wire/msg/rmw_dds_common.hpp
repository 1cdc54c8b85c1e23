// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/wire/field.hpp"
// What ROS 2 tools know of nodes comes from these, on the topic ros_discovery_info.

namespace bpa::wire::rmw_dds_common {

/// A DDS GUID: 12 bytes of prefix, 4 of entity id. (24 bytes in Humble; see graph.hpp.)
struct Gid {
  static constexpr const char* kType = "rmw_dds_common/msg/Gid";
  std::array<std::uint8_t, 16> data{};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("data", self.data);
  }
};

struct NodeEntitiesInfo {
  static constexpr const char* kType = "rmw_dds_common/msg/NodeEntitiesInfo";
  std::string node_namespace;
  std::string node_name;
  std::vector<Gid> reader_gid_seq;
  std::vector<Gid> writer_gid_seq;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("node_namespace", self.node_namespace, Bound{256});
    visit("node_name", self.node_name, Bound{256});
    visit("reader_gid_seq", self.reader_gid_seq);
    visit("writer_gid_seq", self.writer_gid_seq);
  }
};

struct ParticipantEntitiesInfo {
  static constexpr const char* kType = "rmw_dds_common/msg/ParticipantEntitiesInfo";
  Gid gid;
  std::vector<NodeEntitiesInfo> node_entities_info_seq;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("gid", self.gid);
    visit("node_entities_info_seq", self.node_entities_info_seq);
  }
};

}  // namespace bpa::wire::rmw_dds_common
