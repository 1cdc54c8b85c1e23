// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/bag_writer.hpp"

#include <stdexcept>

#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

namespace bpa::support {
namespace {

template <class T>
std::string number(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string text(const std::string& bytes) {
  return number(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

std::string record(int opcode, const std::string& content) {
  return static_cast<char>(opcode) + number(static_cast<std::uint64_t>(content.size())) + content;
}

std::string zstd_of(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

std::string lz4_of(const std::string& bytes) {
  std::string out(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  return out;
}

std::string chunk(const std::string& records, McapKind kind) {
  const auto* bytes = reinterpret_cast<const Bytef*>(records.data());
  const auto crc = static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(records.size())));
  std::string name, compressed = records;
  if (kind == McapKind::lz4) name = "lz4", compressed = lz4_of(records);
  if (kind == McapKind::zstd) name = "zstd", compressed = zstd_of(records);
  return record(6, number(std::uint64_t{0}) + number(std::uint64_t{0}) +
                       number(static_cast<std::uint64_t>(records.size())) + number(crc) +
                       text(name) + number(static_cast<std::uint64_t>(compressed.size())) +
                       compressed);
}

}  // namespace

std::string mcap_of(const std::vector<RecordedMessage>& messages, McapKind kind,
                    const std::string& encoding) {
  const std::string magic = "\x89MCAP0\r\n";
  std::string file = magic + record(1, text("ros2") + text("tests"));
  std::map<std::string, std::uint16_t> channels;
  for (const RecordedMessage& message : messages) {
    const auto [channel, is_new] = channels.try_emplace(message.topic, channels.size() + 1);
    const std::uint16_t id = channel->second;
    std::string records;
    if (is_new) {
      records += record(3, number(id) + text(message.type) + text("ros2msg") + text("..."));
      records += record(4, number(id) + number(id) + text(message.topic) + text(encoding) +
                               text(text("offered_qos_profiles") + text("")));
    }
    const auto time = number(static_cast<std::uint64_t>(message.time_ns));
    records += record(5, number(id) + number(std::uint32_t{0}) + time + time + message.cdr);
    file += kind == McapKind::no_chunks ? records : chunk(records, kind);
    if (kind != McapKind::no_chunks) file += record(7, number(id) + number(std::uint32_t{0}));
  }
  file += record(15, number(std::uint32_t{0}));
  file += record(2, number(std::uint64_t{0}) + number(std::uint64_t{0}) + number(std::uint32_t{0}));
  return file + magic;
}

void write_db3(const std::string& path, const std::vector<RecordedMessage>& messages, bool zstd) {
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  const auto run = [&](const std::string& sql) {
    if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
      throw std::runtime_error(sqlite3_errmsg(database));
    }
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN");
  std::map<std::string, std::size_t> topics;
  for (const RecordedMessage& message : messages) {
    const auto [topic, is_new] = topics.try_emplace(message.topic, topics.size() + 1);
    const std::string id = std::to_string(topic->second);
    if (is_new) {
      run("INSERT INTO topics VALUES(" + id + ", '" + message.topic + "', '" + message.type +
          "', 'cdr', '')");
    }
    const std::string bytes = zstd ? zstd_of(message.cdr) : message.cdr;
    sqlite3_stmt* insert = nullptr;
    const std::string sql = "INSERT INTO messages(topic_id, timestamp, data) VALUES(" + id + ", " +
                            std::to_string(message.time_ns) + ", ?)";
    sqlite3_prepare_v2(database, sql.c_str(), -1, &insert, nullptr);
    sqlite3_bind_blob(insert, 1, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
    sqlite3_step(insert);
    sqlite3_finalize(insert);
  }
  run("COMMIT");
  sqlite3_close(database);
}

}  // namespace bpa::support
