// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/private/graph.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "idl/wire/msg/rmw_dds_common.hpp"

namespace bpa::wire::detail {
namespace {

Guid guid_of(std::uint8_t value) {
  Guid guid;
  guid.fill(value);
  return guid;
}

TEST(Graph, IronLayoutIsTheMessage) {
  const auto bytes = encode_graph(GraphLayout::iron16, guid_of(1), {"/robot", "bpa"},
                                  {guid_of(2), guid_of(3)}, {guid_of(4)});
  rmw_dds_common::ParticipantEntitiesInfo info;
  ASSERT_TRUE(decode(bytes.data(), bytes.size(), info).ok());
  EXPECT_EQ(info.gid.data, guid_of(1));
  ASSERT_EQ(info.node_entities_info_seq.size(), 1U);
  const auto& node = info.node_entities_info_seq[0];
  EXPECT_EQ(node.node_namespace, "/robot");
  EXPECT_EQ(node.node_name, "bpa");
  ASSERT_EQ(node.reader_gid_seq.size(), 2U);
  EXPECT_EQ(node.reader_gid_seq[1].data, guid_of(3));
  ASSERT_EQ(node.writer_gid_seq.size(), 1U);
}

TEST(Graph, HumbleLayoutPadsIdsTo24Bytes) {
  const auto iron = encode_graph(GraphLayout::iron16, guid_of(1), {"/", "abc"}, {guid_of(2)}, {});
  const auto humble =
      encode_graph(GraphLayout::humble24, guid_of(1), {"/", "abc"}, {guid_of(2)}, {});
  ASSERT_EQ(humble.size(), iron.size() + 2 * 8);
  EXPECT_EQ(std::vector<std::uint8_t>(humble.begin() + 20, humble.begin() + 28),
            std::vector<std::uint8_t>(8, 0));
  EXPECT_EQ(humble[28], 1);  // one node follows
}

TEST(Graph, LayoutIsGuessedFromOthers) {
  GraphLayoutGuess guess;
  EXPECT_EQ(guess.layout(), GraphLayout::iron16);
  guess.discovered(guid_of(9), "typehash=RIHS01_0;bpa=1;");  // our own kind is no evidence
  EXPECT_EQ(guess.layout(), GraphLayout::iron16);
  guess.discovered(guid_of(1), "");
  EXPECT_EQ(guess.layout(), GraphLayout::humble24);
  guess.discovered(guid_of(2), "typehash=RIHS01_0;");
  EXPECT_EQ(guess.layout(), GraphLayout::iron16);
  guess.removed(guid_of(2));
  EXPECT_EQ(guess.layout(), GraphLayout::humble24);
  guess.removed(guid_of(1));
  EXPECT_EQ(guess.layout(), GraphLayout::iron16);
}

}  // namespace
}  // namespace bpa::wire::detail
