// SPDX-License-Identifier: Apache-2.0
#include "store/sqlite_store.h"

#include <sqlite3.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "store/store_errors.h"

namespace posespace {
namespace {

// "pose" in the file's header, so that another program's database is not taken for ours.
constexpr int kApplicationId = 0x706f7365;
constexpr int kSchemaVersion = 1;

// Another process that is just ending has this long to let go of the file.
constexpr int kPatienceMs = 1000;

// The write-ahead log shrinks back to this after a large upload, bytes.
constexpr int kKeptLogBytes = 16 << 20;

constexpr char kSchema[] =
    "CREATE TABLE sessions("
    "  id TEXT PRIMARY KEY, request_id TEXT NOT NULL, record BLOB NOT NULL);"
    "CREATE TABLE blobs(key TEXT PRIMARY KEY, bytes BLOB NOT NULL);"
    "CREATE TABLE uses("
    "  session TEXT NOT NULL, key TEXT NOT NULL, PRIMARY KEY(session, key)) WITHOUT ROWID;"
    "CREATE INDEX uses_by_key ON uses(key);";

Error Unavailable(std::string message) {
  return Error{ErrorCode::kStoreUnavailable, std::move(message), {}};
}

Error FailureOf(int code) {
  const std::string reason = sqlite3_errstr(code);
  const int primary = code & 0xff;
  if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) {
    return Error{ErrorCode::kSnapshotCorrupt, "the store's file is damaged: " + reason, {}};
  }
  return Unavailable("the store cannot be used now: " + reason);
}

// One prepared statement of one call.
class Statement {
 public:
  Statement(sqlite3* connection, std::string_view sql) {
    code_ = sqlite3_prepare_v2(connection, sql.data(), static_cast<int>(sql.size()), &statement_,
                               nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  // Parameters in order; what is bound outlives the statement.
  Statement& Bind(std::string_view text) {
    return Note(sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(), SQLITE_STATIC,
                                    SQLITE_UTF8));
  }
  Statement& Bind(std::span<const std::uint8_t> bytes) {
    // A null pointer would bind NULL.
    static constexpr std::uint8_t kNothing = 0;
    return Note(sqlite3_bind_blob64(statement_, ++bound_, bytes.empty() ? &kNothing : bytes.data(),
                                    bytes.size(), SQLITE_STATIC));
  }

  // True while there is a row.
  Result<bool> Step() {
    if (code_ == SQLITE_OK) code_ = sqlite3_step(statement_);
    const int stepped = std::exchange(code_, SQLITE_OK);
    if (stepped == SQLITE_ROW) return true;
    if (stepped == SQLITE_DONE) return false;
    return FailureOf(stepped);
  }

  // Runs a statement that gives no rows.
  Result<void> Run() {
    while (TRY(Step())) continue;
    return {};
  }

  std::string Text(int column) const {
    const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return {text == nullptr ? "" : text,
            static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }
  Bytes Blob(int column) const {
    const auto* const bytes =
        static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    return {bytes, bytes + sqlite3_column_bytes(statement_, column)};
  }
  int Number(int column) const { return sqlite3_column_int(statement_, column); }

 private:
  Statement& Note(int code) {
    if (code_ == SQLITE_OK) code_ = code;
    return *this;
  }

  sqlite3_stmt* statement_ = nullptr;
  int code_ = SQLITE_OK;
  int bound_ = 0;
};

}  // namespace

struct SqliteStore::Database {
  ~Database() { sqlite3_close(connection); }

  sqlite3* connection = nullptr;
  mutable std::mutex mutex;  // one call at a time has the connection

  Result<void> Execute(std::string_view sql) const { return Statement(connection, sql).Run(); }

  Result<int> NumberOf(std::string_view sql) const {
    Statement statement(connection, sql);
    const bool found = TRY(statement.Step());
    return found ? statement.Number(0) : 0;
  }

  // Does all of `work` or nothing.
  template <typename Work>
  Result<void> Transact(Work work) {
    const std::lock_guard lock(mutex);
    TRY(Execute("BEGIN IMMEDIATE"));
    Result<void> done = work();
    if (done) done = Execute("COMMIT");
    // After some failures the database has rolled back by itself.
    if (!done && sqlite3_get_autocommit(connection) == 0) {
      if (Result<void> undone = Execute("ROLLBACK"); !undone) return undone;
    }
    return done;
  }

  Result<bool> HasSession(const std::string& id) const {
    return Statement(connection, "SELECT 1 FROM sessions WHERE id = ?").Bind(id).Step();
  }

  Result<std::set<std::string>> UsesOf(const std::string& id) const {
    Statement statement(connection, "SELECT key FROM uses WHERE session = ?");
    statement.Bind(id);
    std::set<std::string> keys;
    while (TRY(statement.Step())) keys.insert(statement.Text(0));
    return keys;
  }

  Result<void> Forsake(const std::string& id, const std::string& key) const {
    TRY(Statement(connection, "DELETE FROM uses WHERE session = ? AND key = ?")
            .Bind(id)
            .Bind(key)
            .Run());
    return Statement(connection,
                     "DELETE FROM blobs WHERE key = ?1 AND NOT EXISTS "
                     "(SELECT 1 FROM uses WHERE uses.key = ?1)")
        .Bind(key)
        .Run();
  }

  // `what` in one row's only column; nothing when there is no row.
  Result<std::optional<Bytes>> Read(std::string_view sql, const std::string& key) const {
    const std::lock_guard lock(mutex);
    Statement statement(connection, sql);
    statement.Bind(key);
    if (!TRY(statement.Step())) return std::optional<Bytes>();
    return std::optional(statement.Blob(0));
  }

  Result<void> SetUp();
};

// Takes the file for this process, and makes it ours when it is new.
Result<void> SqliteStore::Database::SetUp() {
  sqlite3_extended_result_codes(connection, 1);
  sqlite3_busy_timeout(connection, kPatienceMs);
  // Before the first read: then the log's index is in our memory, and no other process can join.
  TRY(Execute("PRAGMA locking_mode = EXCLUSIVE"));
  TRY(Execute("PRAGMA journal_mode = WAL"));
  TRY(Execute("PRAGMA synchronous = FULL"));
  TRY(Execute("PRAGMA journal_size_limit = " + std::to_string(kKeptLogBytes)));
  return Transact([&]() -> Result<void> {
    const int version = TRY(NumberOf("PRAGMA user_version"));
    const int tables = TRY(NumberOf("SELECT count(*) FROM sqlite_schema"));
    if (version == 0 && tables == 0) {
      if (sqlite3_exec(connection, kSchema, nullptr, nullptr, nullptr) != SQLITE_OK) {
        return FailureOf(sqlite3_extended_errcode(connection));
      }
      TRY(Execute("PRAGMA application_id = " + std::to_string(kApplicationId)));
      return Execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
    }
    if (TRY(NumberOf("PRAGMA application_id")) != kApplicationId) {
      return Unavailable("it is a database of another program");
    }
    if (version > kSchemaVersion) {
      return Unavailable("it was written by a newer version of posespaced (schema " +
                         std::to_string(version) +
                         ", known here: " + std::to_string(kSchemaVersion) + ")");
    }
    // Proves that the file can be written, before anybody relies on it.
    return Execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  });
}

SqliteStore::SqliteStore(std::unique_ptr<Database> database) : database_(std::move(database)) {}

SqliteStore::~SqliteStore() = default;

Result<std::unique_ptr<Store>> SqliteStore::Open(const std::string& path) {
  const auto refuse = [&path](const std::string& reason) {
    return Unavailable("cannot open the store '" + path + "': " + reason);
  };
  std::error_code failed;
  const auto absolute = std::filesystem::absolute(path, failed);  // ":memory:" is a file, too
  const auto folder = absolute.parent_path();
  if (std::filesystem::create_directories(folder, failed)) {
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, failed);
  }
  if (failed) return refuse(failed.message());

  auto database = std::make_unique<Database>();
  const int opened = sqlite3_open_v2(absolute.c_str(), &database->connection,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  if (opened != SQLITE_OK) return refuse(sqlite3_errstr(opened));
  if (const auto ready = database->SetUp(); !ready) {
    const bool busy = (sqlite3_errcode(database->connection) & 0xff) == SQLITE_BUSY;
    return refuse(busy ? "another process has it open; talk to that one, or name another file"
                       : ready.error().message);
  }
  return std::unique_ptr<Store>(new SqliteStore(std::move(database)));
}

Result<std::vector<Store::Entry>> SqliteStore::List() const {
  const std::lock_guard lock(database_->mutex);
  Statement statement(database_->connection, "SELECT id, request_id FROM sessions ORDER BY id");
  std::vector<Entry> entries;
  while (TRY(statement.Step())) entries.push_back({statement.Text(0), statement.Text(1)});
  return entries;
}

Result<void> SqliteStore::Insert(const Entry& entry, std::span<const std::uint8_t> record) {
  return database_->Transact([&]() -> Result<void> {
    if (TRY(database_->HasSession(entry.id))) return StoredAlready(entry.id);
    return Statement(database_->connection, "INSERT INTO sessions VALUES (?, ?, ?)")
        .Bind(entry.id)
        .Bind(entry.request_id)
        .Bind(record)
        .Run();
  });
}

Result<void> SqliteStore::Update(const std::string& id, std::span<const std::uint8_t> record,
                                 std::span<const std::string> uses, std::span<const Blob> blobs) {
  return database_->Transact([&]() -> Result<void> {
    if (!TRY(database_->HasSession(id))) return NotStored(id);
    sqlite3* const connection = database_->connection;
    TRY(Statement(connection, "UPDATE sessions SET record = ?2 WHERE id = ?1")
            .Bind(id)
            .Bind(record)
            .Run());

    const std::set<std::string> before = TRY(database_->UsesOf(id));
    const std::set<std::string> now(uses.begin(), uses.end());
    for (const Blob& blob : blobs) {
      if (!now.contains(blob.key)) continue;
      TRY(Statement(connection, "INSERT OR REPLACE INTO blobs VALUES (?, ?)")
              .Bind(blob.key)
              .Bind(blob.bytes)
              .Run());
    }
    for (const std::string& key : now) {
      if (before.contains(key)) continue;
      TRY(Statement(connection, "INSERT INTO uses VALUES (?, ?)").Bind(id).Bind(key).Run());
    }
    for (const std::string& key : before) {
      if (!now.contains(key)) TRY(database_->Forsake(id, key));
    }
    return {};
  });
}

Result<void> SqliteStore::Remove(const std::string& id) {
  return database_->Transact([&]() -> Result<void> {
    if (!TRY(database_->HasSession(id))) return NotStored(id);
    for (const std::string& key : TRY(database_->UsesOf(id))) TRY(database_->Forsake(id, key));
    return Statement(database_->connection, "DELETE FROM sessions WHERE id = ?").Bind(id).Run();
  });
}

Result<Bytes> SqliteStore::ReadRecord(const std::string& id) const {
  auto record = TRY(database_->Read("SELECT record FROM sessions WHERE id = ?", id));
  if (!record) return NotStored(id);
  return *std::move(record);
}

Result<Bytes> SqliteStore::ReadBlob(const std::string& key) const {
  auto bytes = TRY(database_->Read("SELECT bytes FROM blobs WHERE key = ?", key));
  if (!bytes) return BlobMissing(key);
  return *std::move(bytes);
}

}  // namespace posespace
