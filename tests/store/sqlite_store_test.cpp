// SPDX-License-Identifier: Apache-2.0
// What a file promises beyond a store in memory: it stays, and it is guarded.
#include "store/sqlite_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace posespace {
namespace {

using ::testing::HasSubstr;

Bytes BytesOf(const std::string& text) { return {text.begin(), text.end()}; }

class SqliteStoreTest : public testing::Test {
 protected:
  Result<std::unique_ptr<Store>> Open() { return SqliteStore::Open(path_); }

  // Runs SQL on the file as another program would.
  void Execute(const std::string& sql) {
    sqlite3* connection = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &connection), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(connection, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(connection);
  }

  // Runs `work` in a process of its own, which ends without letting go of anything.
  template <typename Work>
  void InAProcessThatIsKilled(Work work) {
    const pid_t child = fork();
    if (child == 0) {
      work();
      raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_ / "store.sqlite";
};

TEST_F(SqliteStoreTest, HasEverythingAfterItIsOpenedAgain) {
  {
    const auto store = Open().value();
    ASSERT_THAT(store->Insert({"tux", "r1"}, BytesOf("record")), Succeeds());
    ASSERT_THAT(store->Update("tux", BytesOf("record 2"), std::vector<std::string>{"a"},
                              std::vector<Blob>{{"a", BytesOf("A")}}),
                Succeeds());
  }
  const auto store = Open().value();
  ASSERT_EQ(store->List()->size(), 1u);
  EXPECT_EQ(store->List()->front().id, "tux");
  EXPECT_EQ(store->List()->front().request_id, "r1");
  EXPECT_EQ(*store->ReadRecord("tux"), BytesOf("record 2"));
  EXPECT_EQ(*store->ReadBlob("a"), BytesOf("A"));
}

TEST_F(SqliteStoreTest, HasEverythingAfterItsProcessWasKilled) {
  InAProcessThatIsKilled([&] {
    const auto store = Open().value();
    for (int k = 0; k < 20; ++k) {
      const std::string id = std::to_string(k);
      (void)store->Insert({id, "r" + id}, BytesOf(id));
      (void)store->Update(id, BytesOf("updated " + id), std::vector<std::string>{"blob " + id},
                          std::vector<Blob>{{"blob " + id, Bytes(100'000, 7)}});
    }
    (void)store->Remove("3");
  });
  const auto store = Open().value();
  EXPECT_EQ(store->List()->size(), 19u);
  for (int k = 0; k < 20; ++k) {
    const std::string id = std::to_string(k);
    if (k == 3) continue;
    EXPECT_EQ(*store->ReadRecord(id), BytesOf("updated " + id));
    EXPECT_EQ(*store->ReadBlob("blob " + id), Bytes(100'000, 7));
  }
}

TEST_F(SqliteStoreTest, IsOpenInOneProcessAtATime) {
  const auto store = Open().value();
  const pid_t child = fork();
  if (child == 0) {
    const auto second = SqliteStore::Open(path_);
    const bool refused = !second && second.error().code == ErrorCode::kStoreUnavailable &&
                         second.error().message.find("another process") != std::string::npos;
    _exit(refused ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_THAT(store->Insert({"tux", ""}, BytesOf("x")), Succeeds());
}

TEST_F(SqliteStoreTest, RefusesAFileOfANewerVersion) {
  ASSERT_THAT(Open(), Succeeds());
  Execute("PRAGMA user_version = 2");
  const auto store = Open();
  ASSERT_THAT(store, FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(store.error().message, HasSubstr("newer version"));
  EXPECT_THAT(store.error().message, HasSubstr(path_));
}

TEST_F(SqliteStoreTest, RefusesTheDatabaseOfAnotherProgramAndLeavesItAlone) {
  Execute("CREATE TABLE recipes(name TEXT)");
  const auto store = Open();
  ASSERT_THAT(store, FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(store.error().message, HasSubstr("another program"));
  Execute("INSERT INTO recipes VALUES ('soup')");
}

TEST_F(SqliteStoreTest, RefusesAFileThatIsNoDatabase) {
  std::ofstream(path_) << std::string(10'000, 'x');
  const auto store = Open();
  ASSERT_THAT(store, FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(store.error().message, HasSubstr(path_));
}

TEST_F(SqliteStoreTest, MakesItsFolderForItsOwnerAlone) {
  ASSERT_THAT(SqliteStore::Open(folder_ / "a" + "/b/store.sqlite"), Succeeds());
  const auto rights = std::filesystem::status(folder_ / "a" + "/b").permissions();
  EXPECT_EQ(rights, std::filesystem::perms::owner_all);
}

TEST_F(SqliteStoreTest, SaysWhenItsFolderCannotBe) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THAT(SqliteStore::Open(folder_ / "file" + "/store.sqlite"),
              FailsWith(ErrorCode::kStoreUnavailable));
}

TEST_F(SqliteStoreTest, TakesAPathThatSqliteWouldReadAsSomethingElse) {
  const std::string name = ":memory:";
  const auto before = std::filesystem::current_path();
  std::filesystem::create_directories(folder_ / "here");
  std::filesystem::current_path(folder_ / "here");
  ASSERT_THAT(SqliteStore::Open(name), Succeeds());
  EXPECT_TRUE(std::filesystem::exists(name));
  std::filesystem::current_path(before);
}

TEST_F(SqliteStoreTest, SaysThatTheDiskIsFullAndGoesOnWhenItIsNotAnyMore) {
  const auto store = Open().value();
  ASSERT_THAT(store->Insert({"tux", ""}, BytesOf("record")), Succeeds());

  // Files of this process may not grow any more.
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 64 << 10;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto update = [&] {
    return store->Update("tux", BytesOf("record 2"), std::vector<std::string>{"a"},
                         std::vector<Blob>{{"a", Bytes(1 << 20, 1)}});
  };
  const auto refused = update();
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);

  EXPECT_THAT(refused, FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_EQ(*store->ReadRecord("tux"), BytesOf("record")) << "nothing of it happened";
  EXPECT_THAT(update(), Succeeds());
  EXPECT_EQ(store->ReadBlob("a")->size(), 1u << 20);
}

TEST_F(SqliteStoreTest, ListsTenThousandSessionsWithoutReadingThem) {
  {
    const auto store = Open().value();
    ASSERT_THAT(store->Insert({"first", ""}, Bytes(10'000, 1)), Succeeds());
  }
  Execute(
      "WITH RECURSIVE k(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM k WHERE n < 9999) "
      "INSERT INTO sessions SELECT printf('s%05d', n), '', zeroblob(10000) FROM k");
  const auto store = Open().value();
  EXPECT_EQ(store->List()->size(), 10'000u);
}

}  // namespace
}  // namespace posespace
