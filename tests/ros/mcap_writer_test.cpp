// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/mcap_writer.hpp"

#include <gtest/gtest.h>

#include "idl/wire/message_definitions.hpp"
#include "ros/bag_reader.hpp"
#include "tests/support/temporary_folder.hpp"

// tests/system/cli/bag_record_test.cpp has its files read by another reader.

namespace bpa::ros {
namespace {

using test::TemporaryFolder;

/// 40 messages of two topics: one that grows to some chunks, one that is small.
std::vector<std::string> payloads() {
  std::vector<std::string> all;
  for (int i = 0; i < 40; ++i) {
    std::string bytes(i % 2 == 0 ? 150'000 : 9, '\0');
    for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<char>(k * k % 251 + i);
    all.push_back(bytes);
  }
  return all;
}

McapWriter written(const std::string& path) {
  auto writer = McapWriter::create(path);
  EXPECT_TRUE(writer.ok()) << writer.status().message;
  const auto& types = wire::kMessageDefinitions;
  const std::uint16_t topics[] = {writer->add_topic("/large", types[0], {}),
                                  writer->add_topic("/small", types[1], {})};
  std::int64_t time = 5;
  for (const std::string& bytes : payloads()) {
    EXPECT_TRUE(writer->add(topics[time % 2 == 0], time, time - 1, bytes).ok());
    ++time;
  }
  EXPECT_EQ(writer->message_count(), 40U);
  return std::move(writer).value();
}

/// What the recording holds, as far as it can be read, and what then comes of it.
Status read(const std::string& path, std::vector<std::string>& messages) {
  auto reader = open_bag(path);
  EXPECT_TRUE(reader.ok()) << reader.status().message;
  while (true) {
    const auto message = (*reader)->next();
    if (!message.ok()) return message.status();
    if (!*message) return {};
    const std::size_t i = messages.size();
    EXPECT_EQ((*message)->topic->name, i % 2 == 0 ? "/large" : "/small");
    EXPECT_EQ((*message)->topic->type, wire::kMessageDefinitions[i % 2].name);
    EXPECT_EQ((*message)->time_ns, static_cast<std::int64_t>(5 + i));
    messages.emplace_back((*message)->bytes);
  }
}

TEST(McapWriter, WritesWhatTheReaderReads) {
  const TemporaryFolder folder;
  ASSERT_TRUE(written(folder / "a.mcap").finish().ok());
  std::vector<std::string> messages;
  const Status status = read(folder / "a.mcap", messages);
  EXPECT_TRUE(status.ok()) << status.message;
  EXPECT_EQ(messages, payloads());
}

TEST(McapWriter, LeavesItsChunksWhereItIsCutShort) {
  const TemporaryFolder folder;
  ASSERT_TRUE(written(folder / "a.mcap").end_chunk().ok());
  std::vector<std::string> messages;
  EXPECT_EQ(read(folder / "a.mcap", messages).code, StatusCode::corrupt);
  EXPECT_EQ(messages, payloads());
}

TEST(McapWriter, KeepsWhatIsThere) {
  const TemporaryFolder folder;
  test::spill(folder / "a.mcap", "precious");
  const auto message = [&](const std::string& name) {
    return McapWriter::create(folder / name).status().message;
  };
  EXPECT_EQ(message("a.mcap"), folder / "a.mcap" + ": is there already");
  EXPECT_EQ(test::slurp(folder / "a.mcap"), "precious");
  EXPECT_EQ(message("a.bag"), folder / "a.bag" + " must end with .mcap");
  EXPECT_NE(message("no/a.mcap").find("a.mcap cannot be written: No such file"), std::string::npos);
}

}  // namespace
}  // namespace bpa::ros
