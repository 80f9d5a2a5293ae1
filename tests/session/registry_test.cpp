// SPDX-License-Identifier: Apache-2.0
#include "session/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/flaky_store.h"

namespace posespace {
namespace {

Limits IdleLimits() {
  Limits limits;
  limits.concurrent_builds = 0;
  return limits;
}

TEST(Registry, FindsWhatItMade) {
  Registry registry(IdleLimits());
  const auto made = registry.Create({.id = "tux", .display_name = "Tux", .labels = {{"k", "v"}}});
  ASSERT_THAT(made, Succeeds());
  EXPECT_EQ((*made)->View().display_name, "Tux");
  EXPECT_EQ((*made)->View().labels.at("k"), "v");
  EXPECT_EQ(*registry.Find("tux"), *made);
  EXPECT_THAT(registry.Find("Tux"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(registry.Find(""), FailsWith(ErrorCode::kInvalidId));
  EXPECT_THAT(registry.Create({.id = "tux"}), FailsWith(ErrorCode::kSessionExists));
  EXPECT_THAT(registry.Create({.id = "no spaces"}), FailsWith(ErrorCode::kInvalidId));
}

TEST(Registry, ChoosesIdsThatNobodyGuesses) {
  Registry registry(IdleLimits());
  std::set<std::string> ids;
  for (int i = 0; i < 100; ++i) ids.insert((*registry.Create({}))->id());
  EXPECT_EQ(ids.size(), 100u);
  EXPECT_THAT(ids, testing::Each(testing::SizeIs(32)));
}

TEST(Registry, AnswersARepeatedRequestWithTheFirstSession) {
  Registry registry(IdleLimits());
  const auto first = registry.Create({.request_id = "r1"});
  EXPECT_EQ(*registry.Create({.request_id = "r1"}), *first);
  EXPECT_NE(*registry.Create({.request_id = "r2"}), *first);
  const auto named = registry.Create({.id = "tux", .request_id = "r3"});
  EXPECT_EQ(*registry.Create({.id = "tux", .request_id = "r3"}), *named);
  EXPECT_THAT(registry.Create({.id = "tux", .request_id = "r4"}),
              FailsWith(ErrorCode::kSessionExists));
  EXPECT_THAT(registry.Create({.id = "nix", .request_id = "r3"}),
              FailsWith(ErrorCode::kInvalidOption, "request_id"));
  ASSERT_THAT(registry.Delete("tux", ""), Succeeds());
  EXPECT_NE(*registry.Create({.id = "tux", .request_id = "r3"}), *named);
}

TEST(Registry, HoldsAsManySessionsAsItsLimit) {
  Limits limits = IdleLimits();
  limits.max_sessions = 2;
  Registry registry(limits);
  ASSERT_THAT(registry.Create({.id = "a"}), Succeeds());
  ASSERT_THAT(registry.Create({.id = "b"}), Succeeds());
  EXPECT_THAT(registry.Create({.id = "c"}), FailsWith(ErrorCode::kSessionLimit));
  ASSERT_THAT(registry.Delete("a", ""), Succeeds());
  EXPECT_THAT(registry.Create({.id = "c"}), Succeeds());
}

TEST(Registry, BoundsTheTextsOfASession) {
  Registry registry(IdleLimits());
  const std::string fits(256, 'x');
  const std::string too_long(257, 'x');
  EXPECT_THAT(registry.Create({.display_name = fits, .labels = {{fits, fits}}, .request_id = fits}),
              Succeeds());
  EXPECT_THAT(registry.Create({.display_name = too_long}),
              FailsWith(ErrorCode::kInvalidOption, "display_name"));
  EXPECT_THAT(registry.Create({.labels = {{too_long, ""}}}),
              FailsWith(ErrorCode::kInvalidOption, "labels"));
  EXPECT_THAT(registry.Create({.labels = {{"k", too_long}}}),
              FailsWith(ErrorCode::kInvalidOption, "labels['k']"));
  EXPECT_THAT(registry.Create({.request_id = too_long}),
              FailsWith(ErrorCode::kInvalidOption, "request_id"));
  NewSession many;
  for (int i = 0; i < 64; ++i) many.labels[std::to_string(i)] = "";
  EXPECT_THAT(registry.Create(many), Succeeds());
  many.labels["one more"] = "";
  EXPECT_THAT(registry.Create(many), FailsWith(ErrorCode::kInvalidOption, "labels"));
}

TEST(Registry, ListsEverySessionOncePageByPage) {
  Registry registry(IdleLimits());
  for (const char* id : {"d", "a", "c", "e", "b"})
    ASSERT_THAT(registry.Create({.id = id}), Succeeds());
  std::vector<std::string> ids;
  std::vector<std::size_t> sizes;
  std::string token;
  do {
    const Registry::Page page = *registry.List(2, token);
    sizes.push_back(page.sessions.size());
    for (const auto& session : page.sessions) ids.push_back(session.id);
    token = page.next_token;
  } while (!token.empty());
  EXPECT_THAT(ids, testing::ElementsAre("a", "b", "c", "d", "e"));
  EXPECT_THAT(sizes, testing::ElementsAre(2, 2, 1));

  EXPECT_TRUE(registry.List(5, "")->next_token.empty());
  EXPECT_EQ(registry.List(0, "")->sessions.size(), 1u);
  EXPECT_TRUE(registry.List(5, "e")->sessions.empty());
  ASSERT_THAT(registry.Delete("b", ""), Succeeds());
  EXPECT_EQ(registry.List(1, "b")->sessions[0].id, "c") << "a page goes on from a deleted one";
}

TEST(Registry, DeletesOnlyWhatTheCallerHasSeen) {
  Registry registry(IdleLimits());
  const auto session = *registry.Create({.id = "tux"});
  const std::string seen = session->etag();
  ASSERT_THAT(session->PutShape("a", CreaturePolygon(0), false), Succeeds());
  EXPECT_THAT(registry.Delete("tux", seen), FailsWith(ErrorCode::kEtagMismatch));
  EXPECT_THAT(registry.Find("tux"), Succeeds());
  EXPECT_THAT(registry.Delete("tux", session->etag()), Succeeds());
  EXPECT_TRUE(session->closed());
  EXPECT_THAT(registry.Find("tux"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(registry.Delete("tux", ""), FailsWith(ErrorCode::kSessionNotFound));
}

TEST(Registry, CancelsTheBuildOfADeletedSession) {
  Registry registry(IdleLimits());
  const auto session = *registry.Create({.id = "tux"});
  ASSERT_THAT(session->PutShape("a", CreaturePolygon(0), false), Succeeds());
  ASSERT_THAT(session->StartBuild({}, registry.build_pool()), Succeeds());
  const auto job = session->LatestBuild();
  job->Watch([&](const BuildStatus&) { (void)registry.Find("tux"); });  // a watcher may look around
  ASSERT_THAT(registry.Delete("tux", ""), Succeeds());
  EXPECT_EQ(job->Status().state, BuildState::kCancelled);
}

TEST(Registry, IsUsedByManyThreadsAtOnce) {
  Registry registry(IdleLimits());
  std::atomic<int> made = 0, deleted = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int k = 0; k < 50; ++k) {
        const std::string id = "s" + std::to_string(k % 10);
        if (registry.Create({.id = id})) ++made;
        if (const auto session = registry.Find(id)) (void)(*session)->View();
        (void)registry.List(5, "s3");
        if (registry.Delete(id, "")) ++deleted;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made - deleted, static_cast<int>(registry.List(100, "")->sessions.size()));
}

TEST(Registry, LeavesSessionsAndBuildsInGoodOrderWhenItGoes) {
  std::shared_ptr<Session> session;
  {
    Registry registry((Limits()));
    session = *registry.Create({.id = "tux"});
    for (const char id : {'a', 'b', 'c'}) {
      ASSERT_THAT(
          session->PutShape(std::string(1, id), CreaturePolygon(0.1 * (id - 'a'), 2000), false),
          Succeeds());
    }
    ASSERT_THAT(session->StartBuild({0.001, 0.02}, registry.build_pool()), Succeeds());
  }
  EXPECT_TRUE(session->LatestBuild()->ended());
}

// A registry over a store that an earlier one has filled.
class RegistryOfAStore : public testing::Test {
 protected:
  std::unique_ptr<Registry> Open(const Limits& limits = IdleLimits()) {
    return Registry::Open(limits, store_).value();
  }

  // Sessions of one drawing each.
  void Fill(const std::vector<std::string>& ids) {
    const auto registry = Open();
    for (const std::string& id : ids) {
      const auto session = registry->Create({.id = id, .request_id = "make " + id});
      ASSERT_THAT(session, Succeeds());
      ASSERT_THAT((*session)->PutShape("a", CreaturePolygon(0), false), Succeeds());
    }
  }

  const std::shared_ptr<FlakyStore> store_ = std::make_shared<FlakyStore>();
};

TEST_F(RegistryOfAStore, ReadsNoSessionUntilItIsAskedFor) {
  Fill({"a", "b", "c"});
  const auto registry = Open();
  EXPECT_EQ(store_->records_read, 0);
  EXPECT_EQ(registry->num_loaded(), 0u);
  EXPECT_EQ(*registry->Peek("b"), nullptr);
  const auto session = registry->Find("b");
  ASSERT_THAT(session, Succeeds());
  EXPECT_EQ((*session)->View().shape_ids.size(), 1u);
  EXPECT_EQ(*registry->Peek("b"), *session);
  EXPECT_EQ(*registry->Find("b"), *session);
  EXPECT_EQ(store_->records_read, 1);
  EXPECT_EQ(registry->num_loaded(), 1u);
  EXPECT_THAT(registry->Peek("d"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(registry->Peek(""), FailsWith(ErrorCode::kInvalidId));
}

TEST_F(RegistryOfAStore, ListsSessionsWithoutTheirDrawings) {
  Fill({"a", "b", "c"});
  const auto registry = Open();
  ASSERT_THAT(registry->Find("b"), Succeeds());
  const int blobs = store_->blobs_read;
  const auto page = registry->List(10, "");
  ASSERT_THAT(page, Succeeds());
  ASSERT_EQ(page->sessions.size(), 3u);
  for (const SessionView& view : page->sessions) {
    EXPECT_EQ(view.etag, (*registry->Find(view.id))->etag());
    EXPECT_EQ(view.shape_ids, std::vector<std::string>{"a"});
  }
  EXPECT_EQ(registry->num_loaded(), 3u) << "by the Find above";
  EXPECT_EQ(store_->blobs_read, blobs + 2);
}

TEST_F(RegistryOfAStore, AnswersARepeatedRequestOfAnEarlierProcess) {
  Fill({"tux"});
  const auto registry = Open();
  const auto again = registry->Create({.request_id = "make tux"});
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ((*again)->id(), "tux");
  EXPECT_THAT(registry->Create({.id = "tux"}), FailsWith(ErrorCode::kSessionExists));
  EXPECT_THAT(registry->Create({.id = "nix", .request_id = "make tux"}),
              FailsWith(ErrorCode::kInvalidOption, "request_id"));
}

TEST_F(RegistryOfAStore, ForgetsWhatWasDeletedForGood) {
  Fill({"a", "b"});
  ASSERT_THAT(Open()->Delete("a", ""), Succeeds());
  const auto registry = Open();
  EXPECT_THAT(registry->Find("a"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(registry->Find("b"), Succeeds());
  EXPECT_THAT(registry->Create({.id = "a", .request_id = "make a"}), Succeeds());
}

TEST_F(RegistryOfAStore, CreatesNothingThatCannotBeKept) {
  const auto registry = Open();
  store_->fails_writing = true;
  EXPECT_THAT(registry->Create({.id = "tux", .request_id = "r"}),
              FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(registry->Find("tux"), FailsWith(ErrorCode::kSessionNotFound));
  store_->fails_writing = false;
  EXPECT_THAT(registry->Create({.id = "tux", .request_id = "r"}), Succeeds());
  store_->fails_writing = true;
  EXPECT_THAT(registry->Delete("tux", ""), FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(registry->Find("tux"), Succeeds());
}

TEST_F(RegistryOfAStore, TriesAgainToLoadWhatItCouldNot) {
  Fill({"tux"});
  const auto registry = Open();
  store_->fails_reading = true;
  EXPECT_THAT(registry->Find("tux"), FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(registry->List(5, ""), FailsWith(ErrorCode::kStoreUnavailable));
  EXPECT_THAT(Registry::Open(IdleLimits(), store_), FailsWith(ErrorCode::kStoreUnavailable));
  store_->fails_reading = false;
  EXPECT_THAT(registry->Find("tux"), Succeeds());
}

TEST_F(RegistryOfAStore, ShowsADamagedSessionByItsIdAndDeletesIt) {
  Fill({"a", "b"});
  store_->Damage("session/a", [](Bytes& bytes) { bytes.resize(bytes.size() / 2); });
  const auto registry = Open();
  EXPECT_THAT(registry->Find("a"), FailsWith(ErrorCode::kSnapshotCorrupt));
  const auto page = registry->List(5, "");
  ASSERT_THAT(page, Succeeds());
  ASSERT_EQ(page->sessions.size(), 2u);
  EXPECT_EQ(page->sessions[0].id, "a");
  EXPECT_EQ(page->sessions[0].etag, "");
  EXPECT_THAT(registry->Delete("a", "some etag"), FailsWith(ErrorCode::kSnapshotCorrupt));
  EXPECT_THAT(registry->Delete("a", ""), Succeeds());
  EXPECT_THAT(registry->Find("a"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_EQ(Open()->List(5, "")->sessions.size(), 1u);
}

TEST_F(RegistryOfAStore, LetsGoOfTheSessionUsedLeastRecently) {
  Fill({"a", "b", "c"});
  Limits limits = IdleLimits();
  {
    const auto registry = Open();
    limits.max_memory_bytes = 5 * (*registry->Find("a"))->MemoryBytes() / 2;  // two, not three
  }
  const auto registry = Open(limits);
  for (const char* id : {"a", "b", "a", "c"}) ASSERT_THAT(registry->Find(id), Succeeds());
  EXPECT_EQ(registry->num_loaded(), 2u);
  EXPECT_EQ(*registry->Peek("b"), nullptr);
  EXPECT_NE(*registry->Peek("a"), nullptr);
  EXPECT_THAT(registry->Find("b"), Succeeds()) << "it comes back when it is asked for";
}

TEST_F(RegistryOfAStore, KeepsASessionThatSomebodyHoldsOrThatBuilds) {
  Fill({"held", "building", "idle"});
  Limits limits = IdleLimits();
  limits.max_memory_bytes = 1;
  const auto registry = Open(limits);
  const auto held = *registry->Find("held");
  ASSERT_THAT((*registry->Find("building"))->StartBuild({}, registry->build_pool()), Succeeds());
  ASSERT_THAT(registry->Find("idle"), Succeeds());
  registry->Trim();
  EXPECT_EQ(*registry->Peek("held"), held);
  EXPECT_NE(*registry->Peek("building"), nullptr);
  EXPECT_EQ(*registry->Peek("idle"), nullptr);
}

TEST_F(RegistryOfAStore, LoadsASessionOnceForAllWhoAskAtTheSameTime) {
  Fill({"tux"});
  const auto registry = Open();
  std::vector<std::thread> threads;
  std::atomic<int> found = 0;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      if (registry->Find("tux")) ++found;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(found, 8);
  EXPECT_EQ(store_->records_read, 1);
}

TEST_F(RegistryOfAStore, MakesOneSessionOfOneRequestThatComesManyTimesAtOnce) {
  const auto registry = Open();
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::set<std::string> ids;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      const auto session = registry->Create({.request_id = "r"});
      ASSERT_THAT(session, Succeeds());
      const std::lock_guard lock(mutex);
      ids.insert((*session)->id());
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_EQ(store_->List()->size(), 1u);
}

TEST_F(RegistryOfAStore, IsUsedByManyThreadsWhileSessionsComeAndGo) {
  Fill({"s0", "s1", "s2", "s3"});
  Limits limits = IdleLimits();
  limits.max_memory_bytes = 1;
  const auto registry = Open(limits);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int k = 0; k < 40; ++k) {
        const std::string id = "s" + std::to_string((k + t) % 4);
        if (const auto session = registry->Find(id)) {
          (void)(*session)->SetPlacements({{"a", Point(k, t)}}, "");
          (void)(*session)->View();
        }
        (void)registry->Peek(id);
        (void)registry->List(5, "s1");
        if (k % 10 == 9) (void)registry->Delete(id, "");
        if (k % 10 == 5) (void)registry->Create({.id = id});
        registry->Trim();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto left = store_->List();
  const auto page = registry->List(10, "");
  ASSERT_EQ(page->sessions.size(), left->size());
  for (const SessionView& view : page->sessions) {
    EXPECT_EQ(view.etag, (*Session::Load(view.id, limits, store_))->etag());
  }
}

}  // namespace
}  // namespace posespace
