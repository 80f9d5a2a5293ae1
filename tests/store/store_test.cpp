// SPDX-License-Identifier: Apache-2.0
// What every store promises, asked of each of them.
#include "store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "store/open_store.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace posespace {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Bytes BytesOf(const std::string& text) { return {text.begin(), text.end()}; }

class StoreTest : public testing::TestWithParam<std::string> {
 protected:
  StoreTest()
      : store_(OpenStore(GetParam() == "sqlite" ? "sqlite:" + folder_ / "store" : GetParam())
                   .value()) {}

  void Insert(const std::string& id) {
    ASSERT_THAT(store_->Insert({id, ""}, BytesOf("new")), Succeeds());
  }
  Result<void> Update(const std::string& id, const std::vector<std::string>& uses,
                      const std::vector<Blob>& blobs) {
    return store_->Update(id, BytesOf("updated"), uses, blobs);
  }
  std::vector<std::string> Ids() const {
    const auto entries = store_->List();
    std::vector<std::string> ids;
    for (const auto& entry : *entries) ids.push_back(entry.id);
    return ids;
  }

  const TemporaryFolder folder_;
  const std::unique_ptr<Store> store_;
};

INSTANTIATE_TEST_SUITE_P(, StoreTest, testing::Values("memory", "sqlite"),
                         [](const auto& each) { return each.param; });

TEST_P(StoreTest, BeginsEmpty) {
  EXPECT_THAT(Ids(), IsEmpty());
  EXPECT_THAT(store_->ReadRecord("tux"), FailsWith(ErrorCode::kSessionNotFound));
}

TEST_P(StoreTest, GivesBackTheRecordThatItWasGivenLast) {
  ASSERT_THAT(store_->Insert({"tux", "r1"}, BytesOf("first")), Succeeds());
  EXPECT_EQ(*store_->ReadRecord("tux"), BytesOf("first"));
  EXPECT_EQ(store_->List()->front().request_id, "r1");
  ASSERT_THAT(Update("tux", {}, {}), Succeeds());
  EXPECT_EQ(*store_->ReadRecord("tux"), BytesOf("updated"));
  EXPECT_EQ(store_->List()->front().request_id, "r1") << "an update leaves it";
}

TEST_P(StoreTest, ListsIdsInOrder) {
  for (const char* id : {"b", "a", "B", "c.1"}) Insert(id);
  EXPECT_THAT(Ids(), ElementsAre("B", "a", "b", "c.1"));
}

TEST_P(StoreTest, KeepsBytesThatAreAnything) {
  Bytes all;
  for (int k = 0; k < 256; ++k) all.push_back(static_cast<std::uint8_t>(k));
  ASSERT_THAT(store_->Insert({"tux", ""}, Bytes()), Succeeds());
  EXPECT_THAT(*store_->ReadRecord("tux"), IsEmpty());
  ASSERT_THAT(store_->Update("tux", all, std::vector<std::string>{"a", "b"},
                             std::vector<Blob>{{"a", all}, {"b", {}}}),
              Succeeds());
  EXPECT_EQ(*store_->ReadRecord("tux"), all);
  EXPECT_EQ(*store_->ReadBlob("a"), all);
  EXPECT_THAT(*store_->ReadBlob("b"), IsEmpty());
}

TEST_P(StoreTest, RefusesASecondSessionOfTheSameId) {
  Insert("tux");
  EXPECT_THAT(store_->Insert({"tux", ""}, BytesOf("other")), FailsWith(ErrorCode::kSessionExists));
  EXPECT_EQ(*store_->ReadRecord("tux"), BytesOf("new"));
}

TEST_P(StoreTest, UpdatesAndRemovesOnlyWhatIsThere) {
  EXPECT_THAT(Update("tux", {"a"}, {{"a", BytesOf("x")}}), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(store_->Remove("tux"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(store_->ReadBlob("a"), FailsWith(ErrorCode::kSnapshotCorrupt));
}

TEST_P(StoreTest, KeepsABlobForAsLongAsASessionUsesIt) {
  Insert("tux");
  Insert("anna");
  ASSERT_THAT(Update("tux", {"a", "b"}, {{"a", BytesOf("A")}, {"b", BytesOf("B")}}), Succeeds());
  ASSERT_THAT(Update("anna", {"a"}, {{"a", BytesOf("A")}}), Succeeds());

  ASSERT_THAT(Update("tux", {"b"}, {}), Succeeds());
  EXPECT_EQ(*store_->ReadBlob("a"), BytesOf("A")) << "anna uses it";
  EXPECT_EQ(*store_->ReadBlob("b"), BytesOf("B")) << "it need not be given again";
  ASSERT_THAT(store_->Remove("anna"), Succeeds());
  EXPECT_THAT(store_->ReadBlob("a"), FailsWith(ErrorCode::kSnapshotCorrupt));
  ASSERT_THAT(store_->Remove("tux"), Succeeds());
  EXPECT_THAT(store_->ReadBlob("b"), FailsWith(ErrorCode::kSnapshotCorrupt));
  EXPECT_THAT(Ids(), IsEmpty());
}

TEST_P(StoreTest, MendsABlobThatIsGivenAgain) {
  Insert("tux");
  ASSERT_THAT(Update("tux", {"a"}, {{"a", BytesOf("damaged")}}), Succeeds());
  ASSERT_THAT(Update("tux", {"a"}, {{"a", BytesOf("whole")}}), Succeeds());
  EXPECT_EQ(*store_->ReadBlob("a"), BytesOf("whole"));
}

TEST_P(StoreTest, KeepsNoBlobThatNobodyUses) {
  Insert("tux");
  ASSERT_THAT(Update("tux", {}, {{"a", BytesOf("A")}}), Succeeds());
  EXPECT_THAT(store_->ReadBlob("a"), FailsWith(ErrorCode::kSnapshotCorrupt));
}

TEST_P(StoreTest, IsUsedByManyThreadsAtOnce) {
  std::atomic<int> inserted = 0, removed = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int k = 0; k < 25; ++k) {
        const std::string id = "s" + std::to_string(k % 5);
        if (store_->Insert({id, ""}, BytesOf("new"))) ++inserted;
        (void)Update(id, {"shared", std::to_string(t)},
                     {{"shared", BytesOf("S")}, {std::to_string(t), BytesOf("T")}});
        (void)store_->ReadRecord(id);
        (void)store_->ReadBlob("shared");
        (void)store_->List();
        if (store_->Remove(id)) ++removed;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(inserted - removed, std::ssize(Ids()));
}

TEST(OpenStore, RefusesWhatItDoesNotKnow) {
  for (const char* where : {"", "sqlite:", "postgres://host", "Memory", "file.db"}) {
    EXPECT_THAT(OpenStore(where), FailsWith(ErrorCode::kInvalidOption)) << where;
  }
}

}  // namespace
}  // namespace posespace
