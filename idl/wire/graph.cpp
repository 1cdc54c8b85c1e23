// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/graph.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace bpa::wire::detail {
namespace {

/// rmw_dds_common/msg/ParticipantEntitiesInfo of one node, as it is on the wire.
template <std::size_t kIdBytes>
struct State {
  using Id = std::array<std::uint8_t, kIdBytes>;
  Id participant;
  std::uint32_t node_count;
  std::string node_namespace, node_name;
  std::vector<Id> readers, writers;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("gid", self.participant);
    visit("node_entities_info_seq", self.node_count);
    visit("node_namespace", self.node_namespace);
    visit("node_name", self.node_name);
    visit("reader_gid_seq", self.readers);
    visit("writer_gid_seq", self.writers);
  }

  /// Padded with zeros.
  static Id id(const Guid& guid) {
    Id id{};
    std::copy(guid.begin(), guid.end(), id.begin());
    return id;
  }
  static std::vector<Id> ids(const std::set<Guid>& guids) {
    std::vector<Id> ids;
    for (const Guid& guid : guids) ids.push_back(id(guid));
    return ids;
  }
};

}  // namespace

std::vector<std::uint8_t> encode_graph(GraphLayout layout, const Guid& participant,
                                       const NodeName& node, const std::set<Guid>& readers,
                                       const std::set<Guid>& writers) {
  const auto encoded = [&](auto state) {
    return encode(decltype(state){state.id(participant), 1, node.node_namespace, node.name,
                                  state.ids(readers), state.ids(writers)});
  };
  return layout == GraphLayout::humble24 ? encoded(State<24>{}) : encoded(State<16>{});
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
