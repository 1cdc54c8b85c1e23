// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/graph.hpp"

#include <algorithm>

#include "idl/wire/msg/rmw_dds_common.hpp"

namespace bpa::wire::detail {
namespace {

/// The messages as Humble has them: the id padded to 24 bytes.
struct HumbleGid {
  std::array<std::uint8_t, 24> data{};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("data", self.data);
  }
};

struct HumbleNode {
  std::string node_namespace, node_name;
  std::vector<HumbleGid> readers, writers;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("node_namespace", self.node_namespace, Bound{256});
    visit("node_name", self.node_name, Bound{256});
    visit("reader_gid_seq", self.readers);
    visit("writer_gid_seq", self.writers);
  }
};

struct HumbleInfo {
  HumbleGid gid;
  std::vector<HumbleNode> nodes;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("gid", self.gid);
    visit("node_entities_info_seq", self.nodes);
  }
};

template <class Gid>
Gid to_gid(const Guid& guid) {
  Gid gid;
  std::copy(guid.begin(), guid.end(), gid.data.begin());
  return gid;
}

template <class Gid>
std::vector<Gid> to_gids(const std::set<Guid>& guids) {
  std::vector<Gid> gids;
  for (const Guid& guid : guids) gids.push_back(to_gid<Gid>(guid));
  return gids;
}

}  // namespace

std::vector<std::uint8_t> encode_graph(GraphLayout layout, const Guid& participant,
                                       const NodeName& node, const std::set<Guid>& readers,
                                       const std::set<Guid>& writers) {
  if (layout == GraphLayout::humble24) {
    HumbleInfo info;
    info.gid = to_gid<HumbleGid>(participant);
    info.nodes.push_back(
        {node.node_namespace, node.name, to_gids<HumbleGid>(readers), to_gids<HumbleGid>(writers)});
    return encode(info);
  }
  using rmw_dds_common::Gid;
  rmw_dds_common::ParticipantEntitiesInfo info;
  info.gid = to_gid<Gid>(participant);
  info.node_entities_info_seq.push_back(
      {node.node_namespace, node.name, to_gids<Gid>(readers), to_gids<Gid>(writers)});
  return encode(info);
}

void GraphLayoutGuess::discovered(const Guid& endpoint, std::string_view user_data) {
  if (user_data.find(kOwnMark) != std::string_view::npos) return;
  has_hash_[endpoint] = user_data.find("typehash=") != std::string_view::npos;
}

void GraphLayoutGuess::removed(const Guid& endpoint) { has_hash_.erase(endpoint); }

GraphLayout GraphLayoutGuess::layout() const {
  const bool only_humble =
      !has_hash_.empty() && std::none_of(has_hash_.begin(), has_hash_.end(),
                                         [](const auto& entry) { return entry.second; });
  return only_humble ? GraphLayout::humble24 : GraphLayout::iron16;
}

}  // namespace bpa::wire::detail
