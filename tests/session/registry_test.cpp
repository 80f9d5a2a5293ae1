// SPDX-License-Identifier: Apache-2.0
#include "session/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <thread>

#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"

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
  Registry::NewSession many;
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
    const Registry::Page page = registry.List(2, token);
    sizes.push_back(page.sessions.size());
    for (const auto& session : page.sessions) ids.push_back(session->id());
    token = page.next_token;
  } while (!token.empty());
  EXPECT_THAT(ids, testing::ElementsAre("a", "b", "c", "d", "e"));
  EXPECT_THAT(sizes, testing::ElementsAre(2, 2, 1));

  EXPECT_TRUE(registry.List(5, "").next_token.empty());
  EXPECT_EQ(registry.List(0, "").sessions.size(), 1u);
  EXPECT_TRUE(registry.List(5, "e").sessions.empty());
  ASSERT_THAT(registry.Delete("b", ""), Succeeds());
  EXPECT_EQ(registry.List(1, "b").sessions[0]->id(), "c") << "a page goes on from a deleted one";
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
  EXPECT_EQ(made - deleted, static_cast<int>(registry.List(100, "").sessions.size()));
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

}  // namespace
}  // namespace posespace
