// SPDX-License-Identifier: Apache-2.0
// What a session keeps, and what it is when it comes back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <semaphore>
#include <string>
#include <thread>

#include "session/session.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/flaky_store.h"

namespace posespace {
namespace {

constexpr auto kUnavailable = ErrorCode::kStoreUnavailable;
constexpr auto kCorrupt = ErrorCode::kSnapshotCorrupt;

Limits OneWorker() {
  Limits limits;
  limits.concurrent_builds = 1;
  return limits;
}

BuildStatus EndOf(BuildJob& job) {
  std::binary_semaphore ended(0);
  const auto token = job.Watch([&](const BuildStatus& status) {
    if (status.ended()) ended.release();
  });
  ended.acquire();
  job.Unwatch(token);
  return job.Status();
}

class SessionStore : public testing::Test {
 protected:
  SessionStore() {
    session_ = Session::Create({.id = "tux", .display_name = "Tux", .labels = {{"k", "v"}}},
                               Limits(), store_)
                   .value();
  }

  void Put(const std::string& ids) {
    for (const char id : ids) {
      ASSERT_THAT(session_->PutShape(std::string(1, id), CreaturePicture(0.1 * (id - 'a')), true),
                  Succeeds());
    }
  }
  BuildStatus Build() {
    const auto started = session_->StartBuild(kRequest, pool_);
    EXPECT_THAT(started, Succeeds());
    return EndOf(*session_->LatestBuild());
  }
  Result<std::shared_ptr<Session>> Loaded() { return Session::Load("tux", Limits(), store_); }

  // Everything that a caller can see of two sessions.
  static void ExpectSame(const Session& a, const Session& b) {
    const SessionView one = a.View(), two = b.View();
    EXPECT_EQ(one.id, two.id);
    EXPECT_EQ(one.display_name, two.display_name);
    EXPECT_EQ(one.labels, two.labels);
    EXPECT_EQ(one.shape_ids, two.shape_ids);
    EXPECT_EQ(one.correspondences, two.correspondences);
    EXPECT_EQ(one.placements, two.placements);
    EXPECT_EQ(one.placements_are_default, two.placements_are_default);
    EXPECT_EQ(one.etag, two.etag);
    EXPECT_EQ(one.created, two.created);
    EXPECT_EQ(one.updated, two.updated);
    EXPECT_EQ(one.revision, two.revision);
    for (const std::string& id : one.shape_ids) {
      const auto drawing = *a.FindShape(id), again = *b.FindShape(id);
      EXPECT_EQ(drawing->digest, again->digest);
      EXPECT_EQ(drawing->outline.outer, again->outline.outer);
      EXPECT_EQ(TextureOf(*drawing).image.rgba, TextureOf(*again).image.rgba);
    }
    const auto built = a.Built(), built_again = b.Built();
    ASSERT_EQ(built.has_value(), built_again.has_value());
    if (!built) return;
    for (const Point& at : {Point(0.1, 0.2), Point(-3, 1), Point(0.5, 0.5)}) {
      EXPECT_EQ((*built)->Blend({at, {}, 0.0})->vertices,
                (*built_again)->Blend({at, {}, 0.0})->vertices);
    }
  }

  static constexpr BuildRequest kRequest{0.03, 0.25};
  const std::shared_ptr<FlakyStore> store_ = std::make_shared<FlakyStore>();
  BuildPool pool_{OneWorker()};
  BuildPool idle_{[] {
    Limits limits;
    limits.concurrent_builds = 0;
    return limits;
  }()};
  std::shared_ptr<Session> session_;
};

TEST_F(SessionStore, IsTheSameAfterEveryEdit) {
  const auto check = [&](const std::string& after) {
    SCOPED_TRACE(after);
    const auto again = Loaded();
    ASSERT_THAT(again, Succeeds());
    ExpectSame(*session_, **again);
  };
  check("create");
  Put("abc");
  check("put");
  Put("b");
  check("put again");
  const Points ring = (*session_->FindShape("a"))->outline.outer;
  ASSERT_THAT(session_->SetCorrespondences({{{"a", ring.row(0)}}}, ""), Succeeds());
  check("correspondences");
  ASSERT_THAT(
      session_->SetPlacements({{"a", Point(0, 0)}, {"b", Point(1, 0)}, {"c", Point(0, 1)}}, ""),
      Succeeds());
  check("placements");
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  check("build");
  ASSERT_THAT(
      session_->SetPlacements({{"a", Point(0, 0)}, {"b", Point(2, 0)}, {"c", Point(0, 1)}}, ""),
      Succeeds());
  check("placements of a built session");
  ASSERT_THAT(session_->DeleteShape("b"), Succeeds());
  check("delete");
}

TEST_F(SessionStore, GoesOnWhereItWas) {
  Put("ab");
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  const std::string etag = session_->etag();
  session_ = *Loaded();
  EXPECT_EQ(session_->etag(), etag);
  EXPECT_THAT(session_->SetPlacements({}, "another etag"), FailsWith(ErrorCode::kEtagMismatch));
  EXPECT_THAT(session_->SetPlacements({{"a", Point(0, 0)}, {"b", Point(3, 4)}}, etag), Succeeds());
  EXPECT_NE(session_->etag(), etag);
  ASSERT_THAT(session_->SetPlacements({}, ""), Succeeds());
  Put("c");
  EXPECT_EQ(Build().id, "2") << "builds go on counting";
  ExpectSame(*session_, **Loaded());
}

TEST_F(SessionStore, AttachesToTheBuildThatWasFinishedBefore) {
  Put("ab");
  const BuildStatus before = Build();
  session_ = *Loaded();
  const auto again = session_->StartBuild(kRequest, idle_);
  ASSERT_THAT(again, Succeeds());
  EXPECT_TRUE(again->attached);
  EXPECT_EQ(again->id, before.id);
  EXPECT_EQ(again->state, BuildState::kSucceeded);
  ASSERT_NE(again->summary, nullptr);
  EXPECT_EQ(again->summary->revision, before.summary->revision);
  EXPECT_EQ(again->summary->mapping.seconds, before.summary->mapping.seconds);
}

TEST_F(SessionStore, KnowsNothingOfABuildThatWasStillRunning) {
  Put("ab");
  ASSERT_THAT(session_->StartBuild(kRequest, idle_), Succeeds());
  const auto again = *Loaded();
  EXPECT_EQ(again->LatestBuild(), nullptr);
  EXPECT_THAT(again->Built(), FailsWith(ErrorCode::kSessionNotBuilt));
  const auto next = again->StartBuild(kRequest, idle_);
  ASSERT_THAT(next, Succeeds());
  EXPECT_EQ(next->id, "2") << "the number of a build that was lost is not used again";
}

TEST_F(SessionStore, KeepsWhatWasBuiltWhileALaterBuildWasLost) {
  Put("ab");
  const BuildStatus first = Build();
  Put("c");
  ASSERT_THAT(session_->StartBuild(kRequest, idle_), Succeeds());
  const auto again = *Loaded();
  EXPECT_EQ(again->View().revision, first.summary->revision);
  EXPECT_EQ(again->LatestBuild()->Status().id, first.id);
}

TEST_F(SessionStore, IsNotThereOnceDeleted) {
  Put("a");
  ASSERT_THAT(session_->Delete(""), Succeeds());
  EXPECT_THAT(Loaded(), FailsWith(ErrorCode::kSessionNotFound));
}

TEST_F(SessionStore, DoesNotRunAheadOfAStoreThatFails) {
  Put("ab");
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  const SessionView before = session_->View();
  store_->fails_writing = true;
  EXPECT_THAT(session_->PutShape("c", CreaturePicture(0.2), false), FailsWith(kUnavailable));
  EXPECT_THAT(session_->PutShape("a", CreaturePicture(0.3), true), FailsWith(kUnavailable));
  EXPECT_THAT(session_->DeleteShape("a"), FailsWith(kUnavailable));
  EXPECT_THAT(session_->SetCorrespondences({}, ""), FailsWith(kUnavailable));
  EXPECT_THAT(session_->SetPlacements({{"a", Point(0, 0)}, {"b", Point(5, 5)}}, ""),
              FailsWith(kUnavailable));
  EXPECT_THAT(session_->StartBuild({0.05, 0.25}, pool_), FailsWith(kUnavailable));
  EXPECT_THAT(session_->Delete(""), FailsWith(kUnavailable));
  EXPECT_FALSE(session_->closed());
  EXPECT_EQ(session_->View().etag, before.etag);
  EXPECT_EQ(session_->View().revision, before.revision);
  EXPECT_EQ(session_->View().shape_ids, before.shape_ids);
  EXPECT_THAT((*session_->Built())->Blend({Point(0, 0), {}, 0.0}), Succeeds());

  store_->fails_writing = false;
  ExpectSame(*session_, **Loaded());
  Put("c");
  ExpectSame(*session_, **Loaded());
}

TEST_F(SessionStore, SaysThatABuildFailedWhoseResultCouldNotBeKept) {
  Put("ab");
  ASSERT_THAT(session_->StartBuild(kRequest, idle_), Succeeds());
  const auto job = session_->LatestBuild();
  store_->fails_writing = true;
  job->Run(std::chrono::minutes(1));
  EXPECT_EQ(job->Status().state, BuildState::kFailed);
  EXPECT_EQ(job->Status().error->code, kUnavailable);
  EXPECT_THAT(session_->Built(), FailsWith(ErrorCode::kSessionNotBuilt));
  store_->fails_writing = false;
  EXPECT_EQ(Build().state, BuildState::kSucceeded);
  ExpectSame(*session_, **Loaded());
}

TEST_F(SessionStore, SaysThatItsPoseSpaceIsDamagedUntilItIsBuiltAgain) {
  Put("ab");
  const BuildStatus before = Build();
  store_->Damage("pose-space/", [](Bytes& bytes) { bytes[bytes.size() / 2] ^= 1; });
  session_ = *Loaded();
  EXPECT_THAT(session_->Built(), FailsWith(kCorrupt));
  EXPECT_EQ(session_->View().shape_ids.size(), 2u);
  EXPECT_EQ(session_->LatestBuild(), nullptr);

  const BuildStatus again = Build();
  EXPECT_EQ(again.state, BuildState::kSucceeded);
  EXPECT_EQ(again.summary->revision, before.summary->revision);
  EXPECT_THAT(session_->Built(), Succeeds());
  ASSERT_THAT(Loaded(), Succeeds());
  EXPECT_THAT((*Loaded())->Built(), Succeeds()) << "the damaged bytes were replaced";
}

TEST_F(SessionStore, FailsToLoadWithADamagedRecordOrDrawing) {
  Put("ab");
  for (const char* key : {"session/", "drawing/"}) {
    store_->Damage(key, [](Bytes& bytes) { bytes.back() ^= 1; });
    const auto damaged = Loaded();
    ASSERT_THAT(damaged, FailsWith(kCorrupt)) << key;
    EXPECT_THAT(damaged.error().message, testing::HasSubstr("session 'tux'"));
    store_->Heal();
    EXPECT_THAT(Loaded(), Succeeds());
  }
}

TEST_F(SessionStore, LosesNoMoreThanThePoseSpaceWithADrawingThatOnlyItUses) {
  Put("ab");
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  const std::string key = "drawing/" + (*session_->FindShape("b"))->digest;
  ASSERT_THAT(session_->DeleteShape("b"), Succeeds());
  store_->Damage(key, [](Bytes& bytes) { bytes.resize(10); });
  const auto again = *Loaded();
  EXPECT_EQ(again->View().shape_ids, std::vector<std::string>{"a"});
  EXPECT_THAT(again->Built(), FailsWith(kCorrupt));
}

TEST_F(SessionStore, FailsToLoadWhileTheStoreIsAway) {
  Put("a");
  store_->fails_reading = true;
  EXPECT_THAT(Loaded(), FailsWith(kUnavailable));
}

TEST_F(SessionStore, HoldsNoPixelsThatNobodyLooksAt) {
  ASSERT_THAT(session_->PutShape("a", CreaturePicture(0, 512), false), Succeeds());
  EXPECT_TRUE((*session_->FindShape("a"))->texture.image.rgba.empty());
  EXPECT_LT(session_->MemoryBytes(), 200'000) << "512 x 512 pixels are a megabyte";
}

TEST_F(SessionStore, CountsThePixelsThatAPictureNeeds) {
  Put("ab");
  const std::int64_t unbuilt = session_->MemoryBytes();
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  const std::int64_t built = session_->MemoryBytes();
  EXPECT_GT(built, unbuilt + 500'000) << "the weight field alone";
  const auto space = *session_->Built();
  (void)space->Render(*space->Blend({Point(0, 0), {}, 0.0}), space->DefaultView(16, 16));
  EXPECT_EQ(session_->MemoryBytes(), built + 2 * 128 * 128 * 25);
}

}  // namespace
}  // namespace posespace
