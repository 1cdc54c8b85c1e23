// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include <sqlite3.h>

#include "core/base/concat.hpp"
#include "ros/private/bag_files.hpp"

namespace bpa::ros {
namespace {

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

constexpr const char* kMessages =
    "SELECT t.name, t.type, t.serialization_format, m.timestamp, m.data FROM messages m "
    "JOIN topics t ON m.topic_id = t.id ORDER BY m.timestamp";

class SqliteReader : public BagReader {
 public:
  SqliteReader(std::string path, Database database, Statement messages)
      : path_(std::move(path)), database_(std::move(database)), messages_(std::move(messages)) {}

  Result<std::optional<BagMessage>> next() override {
    sqlite3_stmt* row = messages_.get();
    const int step = sqlite3_step(row);
    if (step == SQLITE_DONE) return std::optional<BagMessage>();
    if (step != SQLITE_ROW) return corrupt(path_, ": ", sqlite3_errmsg(database_.get()));
    topic_ = {text(0), text(1)};
    if (const std::string encoding = text(2); encoding != "cdr") {
      return Status(StatusCode::unsupported, concat(path_, ": the messages of ", topic_.name,
                                                    " are ", encoding, "; they must be cdr"));
    }
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(row, 4));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 4));
    return std::optional(
        BagMessage{&topic_, sqlite3_column_int64(row, 3), std::string_view(bytes, size)});
  }

 private:
  std::string text(int column) const {
    const auto* value = sqlite3_column_text(messages_.get(), column);
    return value == nullptr ? "" : reinterpret_cast<const char*>(value);
  }

  const std::string path_;
  const Database database_;
  const Statement messages_;
  BagTopic topic_;
};

}  // namespace

Result<std::unique_ptr<BagReader>> open_sqlite_bag(const std::string& path) {
  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  Database database(opened, sqlite3_close);
  if (status != SQLITE_OK) return not_found(path, ": ", sqlite3_errmsg(opened));
  // A stranger's file: nothing of its schema runs.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostDecompressed));
  sqlite3_stmt* prepared = nullptr;
  const int made = sqlite3_prepare_v2(opened, kMessages, -1, &prepared, nullptr);
  Statement messages(prepared, sqlite3_finalize);
  if (made != SQLITE_OK) {
    return corrupt(path, " is no recording of ROS 2: ", sqlite3_errmsg(opened));
  }
  return std::unique_ptr<BagReader>(
      std::make_unique<SqliteReader>(path, std::move(database), std::move(messages)));
}

}  // namespace bpa::ros
