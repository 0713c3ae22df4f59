#include "calibrato/recording/rosbag2_reader.h"

#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

[[noreturn]] void Fail(const std::string& path, const std::string& why) {
  throw InputError({"cannot read ROS 2 bag", path, why, "copy it again, or record it again"});
}

// A database that is only read, and believed as little as SQLite allows.
class Database {
 public:
  explicit Database(const std::string& path) : path_(path) {
    // An absolute path: SQLite takes some names, like ":memory:", for something else.
    const std::string absolute = std::filesystem::absolute(path).string();
    const int result = sqlite3_open_v2(
        absolute.c_str(), &database_,
        SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE, nullptr);
    if (result != SQLITE_OK) {
      const std::string why = sqlite3_errstr(result);
      sqlite3_close(database_);
      Fail(path_, why);
    }
    constexpr int kMaxBlobBytes = 1 << 30;
    sqlite3_limit(database_, SQLITE_LIMIT_LENGTH, kMaxBlobBytes);
    sqlite3_limit(database_, SQLITE_LIMIT_ATTACHED, 0);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  sqlite3* get() const { return database_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  sqlite3* database_ = nullptr;
};

// A query whose rows are taken one by one.
class Query {
 public:
  Query(const Database& database, const std::string& text) : database_(database) {
    if (sqlite3_prepare_v2(database.get(), text.c_str(), -1, &statement_, nullptr) != SQLITE_OK) {
      Fail(database.path(), sqlite3_errmsg(database.get()));
    }
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  void Bind(int64_t value) { sqlite3_bind_int64(statement_, 1, value); }
  bool Next() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) {
      Fail(database_.path(), sqlite3_errmsg(database_.get()));
    }
    return result == SQLITE_ROW;
  }
  int64_t Integer(int column) { return sqlite3_column_int64(statement_, column); }
  // Valid until the next row.
  std::string_view Bytes(int column) {
    const void* bytes = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    if (bytes == nullptr) return {};
    return {static_cast<const char*>(bytes), static_cast<size_t>(size)};
  }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

class Rosbag2 : public MessageLog {
 public:
  explicit Rosbag2(const std::string& path) : database_(path) {}

  const std::string& path() const override { return database_.path(); }

  void ForEach(const Visit& visit) override {
    const std::lock_guard lock(mutex_);
    CheckTables();
    const std::map<int64_t, LogTopic> topics = Topics();
    std::string numbers;
    for (const auto& [id, topic] : topics) {
      numbers += (numbers.empty() ? "" : ",") + std::to_string(id);
    }
    // The data come last, so that SQLite need not read those of other topics.
    Query messages(database_, "SELECT id, topic_id, data FROM messages WHERE topic_id IN (" +
                                  numbers + ") ORDER BY id");
    while (messages.Next()) {
      const auto topic = topics.find(messages.Integer(1));
      const std::string_view bytes = messages.Bytes(2);
      if (topic == topics.end()) Fail(path(), "a message belongs to no topic");
      visit(topic->second, {static_cast<uint64_t>(messages.Integer(0)), 0, bytes.size()}, bytes);
    }
  }

  std::string Read(const MessagePlace& place) const override {
    const std::lock_guard lock(mutex_);
    Query message(database_, "SELECT data FROM messages WHERE id = ?1");
    message.Bind(static_cast<int64_t>(place.container));
    if (!message.Next()) Fail(path(), "a message has disappeared");
    return std::string(message.Bytes(0));
  }

 private:
  // Only tables as they are stored: a view, or one that a module computes, could have no end.
  void CheckTables() {
    for (const std::string name : {"topics", "messages"}) {
      Query query(database_, "SELECT count(*) FROM sqlite_schema WHERE name = '" + name +
                                 "' AND type = 'table' AND sql LIKE 'CREATE TABLE%' "
                                 "AND sql NOT LIKE '% AS (%' AND sql NOT LIKE '%GENERATED%'");
      if (query.Next() && query.Integer(0) == 1) continue;
      Fail(path(), "the database has no table '" + name + "'");
    }
  }

  std::map<int64_t, LogTopic> Topics() {
    Query query(database_, "SELECT id, name, type, serialization_format FROM topics");
    std::map<int64_t, LogTopic> topics;
    while (query.Next()) {
      const std::string type = KnownMessageType(query.Bytes(2));
      if (type.empty()) continue;
      const std::string name(query.Bytes(1));
      if (query.Bytes(3) != "cdr") Fail(path(), "the messages of " + name + " are not in CDR");
      topics.try_emplace(query.Integer(0), LogTopic{name, type, MessageEncoding::kCdr});
    }
    return topics;
  }

  Database database_;
  mutable std::mutex mutex_;  // one connection, one thread at a time
};

}  // namespace

std::unique_ptr<MessageLog> OpenRosbag2Database(const std::string& path) {
  return std::make_unique<Rosbag2>(path);
}

}  // namespace calibrato
