// SPDX-License-Identifier: Apache-2.0
// From a session's inputs to the pose space that blends use, with everything that can come between.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <semaphore>
#include <set>
#include <thread>

#include "session/session.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

Limits WithWorkers(int workers) {
  Limits limits;
  limits.concurrent_builds = workers;
  return limits;
}

// Waits until a job ended.
BuildStatus EndOf(BuildJob& job) {
  std::binary_semaphore ended(0);
  const auto token = job.Watch([&](const BuildStatus& status) {
    if (status.ended()) ended.release();
  });
  ended.acquire();
  job.Unwatch(token);
  return job.Status();
}

class SessionBuild : public testing::Test {
 protected:
  void Put(const std::string& ids) {
    for (const char id : ids) {
      ASSERT_THAT(session_.PutShape(std::string(1, id), CreaturePolygon(0.1 * (id - 'a')), true),
                  Succeeds());
    }
  }
  BuildStatus Build(const BuildRequest& request = kRequest) {
    EXPECT_THAT(session_.StartBuild(request, pool_), Succeeds());
    return EndOf(*session_.LatestBuild());
  }
  std::string Revision() const { return session_.View().revision; }

  static constexpr BuildRequest kRequest{0.03, 0.25};
  BuildPool idle_{WithWorkers(0)};  // never starts a job
  BuildPool pool_{WithWorkers(2)};
  Session session_{"tux", "", {}, Limits()};
};

TEST_F(SessionBuild, PublishesWhatItBuilt) {
  Put("ab");
  EXPECT_THAT(session_.Built(), FailsWith(ErrorCode::kSessionNotBuilt));
  const std::string etag = session_.etag();
  const BuildStatus status = Build();
  ASSERT_EQ(status.state, BuildState::kSucceeded);
  ASSERT_THAT(session_.Built(), Succeeds());
  EXPECT_EQ(*session_.Built(), status.pose_space);
  EXPECT_EQ(Revision(), status.pose_space->revision());
  EXPECT_NE(session_.etag(), etag);
  EXPECT_EQ(session_.View().build->state, BuildState::kSucceeded);
}

TEST_F(SessionBuild, NeedsADrawing) {
  EXPECT_THAT(session_.StartBuild({}, pool_), FailsWith(ErrorCode::kNoShapes));
  EXPECT_EQ(session_.LatestBuild(), nullptr);
}

TEST_F(SessionBuild, ChecksItsOptionsOnBothSides) {
  Put("a");
  for (const double tolerance : {0.001, 0.2}) {
    EXPECT_THAT(session_.StartBuild({tolerance, 0.08}, idle_), Succeeds());
  }
  for (const double tolerance : {0.0009, 0.201, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(session_.StartBuild({tolerance, 0.08}, idle_),
                FailsWith(ErrorCode::kInvalidOption, "options.tolerance"));
  }
  for (const double length : {0.02, 1.0}) {
    EXPECT_THAT(session_.StartBuild({0.03, length}, idle_), Succeeds());
  }
  for (const double length : {0.019, 1.01}) {
    EXPECT_THAT(session_.StartBuild({0.03, length}, idle_),
                FailsWith(ErrorCode::kInvalidOption, "options.target_edge_length"));
  }
  for (const int vertices : {3, Limits().max_mesh_vertices}) {
    EXPECT_THAT(session_.StartBuild({.max_vertices = vertices}, idle_), Succeeds());
  }
  for (const int vertices : {-1, 0, 2, Limits().max_mesh_vertices + 1}) {
    EXPECT_THAT(session_.StartBuild({.max_vertices = vertices}, idle_),
                FailsWith(ErrorCode::kInvalidOption, "options.max_vertices"));
  }
}

TEST_F(SessionBuild, AttachesToTheRunningBuildOfTheSameInputs) {
  Put("ab");
  const auto first = session_.StartBuild(kRequest, idle_);
  const auto second = session_.StartBuild(kRequest, idle_);
  ASSERT_THAT(second, Succeeds());
  EXPECT_EQ(second->id, first->id);
  EXPECT_EQ(second->state, BuildState::kQueued);
}

TEST_F(SessionBuild, ReturnsTheFinishedBuildOfTheSameInputs) {
  Put("ab");
  const BuildStatus first = Build();
  const auto second = session_.StartBuild(kRequest, idle_);
  ASSERT_THAT(second, Succeeds());
  EXPECT_EQ(second->id, first.id);
  EXPECT_EQ(second->pose_space, first.pose_space);
}

TEST_F(SessionBuild, ReplacesARunningBuildOfOtherInputs) {
  Put("ab");
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  const auto replaced = session_.LatestBuild();
  Put("c");
  const BuildStatus status = Build();
  EXPECT_EQ(replaced->Status().state, BuildState::kCancelled);
  ASSERT_EQ(status.state, BuildState::kSucceeded);
  EXPECT_GT(status.sequence, replaced->Status().sequence);
  EXPECT_EQ((*session_.Built())->drawings().size(), 3u);
}

TEST_F(SessionBuild, NeverPublishesABuildThatWasReplaced) {
  Put("ab");
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  const auto replaced = session_.LatestBuild();
  ASSERT_THAT(session_.StartBuild({0.05, 0.25}, idle_), Succeeds());
  replaced->Run(std::chrono::minutes(1));
  EXPECT_THAT(session_.Built(), FailsWith(ErrorCode::kSessionNotBuilt));
}

TEST_F(SessionBuild, KeepsTheRunningBuildWhenTheNextFindsNoRoom) {
  Put("ab");
  Limits limits = WithWorkers(0);
  limits.build_queue = 1;
  BuildPool full(limits);
  const auto first = session_.StartBuild(kRequest, full);
  EXPECT_THAT(session_.StartBuild({0.05, 0.25}, full), FailsWith(ErrorCode::kBuildQueueFull));
  EXPECT_EQ(session_.LatestBuild()->Status().id, first->id);
  EXPECT_FALSE(session_.LatestBuild()->cancelled());
}

TEST_F(SessionBuild, TriesACancelledBuildAgain) {
  Put("ab");
  const auto first = session_.StartBuild(kRequest, idle_);
  session_.LatestBuild()->Cancel();
  const auto built = session_.Built();
  EXPECT_THAT(built, FailsWith(ErrorCode::kSessionNotBuilt));
  EXPECT_NE(built.error().message.find("cancelled"), std::string::npos);
  const BuildStatus second = Build();
  EXPECT_NE(second.id, first->id);
  EXPECT_EQ(second.state, BuildState::kSucceeded);
}

TEST_F(SessionBuild, SaysWhyItHasNothingBuilt) {
  Put("ab");
  BuildPool hasty([] {
    Limits limits = WithWorkers(1);
    limits.build_timeout = std::chrono::seconds(0);
    return limits;
  }());
  ASSERT_THAT(session_.StartBuild(kRequest, hasty), Succeeds());
  EXPECT_EQ(EndOf(*session_.LatestBuild()).error->code, ErrorCode::kBuildTimeout);
  const auto built = session_.Built();
  EXPECT_THAT(built, FailsWith(ErrorCode::kSessionNotBuilt));
  EXPECT_NE(built.error().message.find("took longer"), std::string::npos);
  EXPECT_EQ(Build().state, BuildState::kSucceeded) << "a failed build is tried again";
}

TEST_F(SessionBuild, KeepsTheOldPoseSpaceUntilTheNextIsBuilt) {
  Put("ab");
  Build();
  const auto before = *session_.Built();
  Put("c");
  EXPECT_EQ(*session_.Built(), before);
  ASSERT_THAT(session_.DeleteShape("a"), Succeeds());
  EXPECT_EQ(*session_.Built(), before);
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  session_.LatestBuild()->Cancel();
  EXPECT_EQ(*session_.Built(), before);
  Build();
  EXPECT_EQ((*session_.Built())->drawings()[0]->id, "b");
}

TEST_F(SessionBuild, MovesTheBuiltPoseSpaceToNewPlacementsAtOnce) {
  Put("ab");
  Build();
  const auto before = *session_.Built();
  const std::string etag = session_.etag();
  ASSERT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(3, 0)}}, ""), Succeeds());
  const auto after = *session_.Built();
  EXPECT_NE(after->revision(), before->revision());
  EXPECT_EQ(&after->mesh(), &before->mesh());
  EXPECT_EQ(after->placements(), PointsOf("0 0, 3 0"));
  EXPECT_NE(session_.etag(), etag);

  const auto again = session_.StartBuild(kRequest, idle_);
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ(again->state, BuildState::kSucceeded) << "these inputs are built already";
  EXPECT_EQ(again->pose_space, after);
  EXPECT_EQ(session_.StartBuild(kRequest, idle_)->id, again->id);

  ASSERT_THAT(session_.SetPlacements({}, ""), Succeeds());
  EXPECT_EQ(Revision(), before->revision());
}

TEST_F(SessionBuild, GivesPlacementsSetWhileItRanToWhatItBuilt) {
  Put("ab");
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  ASSERT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(3, 0)}}, ""), Succeeds());
  session_.LatestBuild()->Run(std::chrono::minutes(1));
  ASSERT_THAT(session_.Built(), Succeeds());
  EXPECT_EQ((*session_.Built())->placements(), PointsOf("0 0, 3 0"));
}

TEST_F(SessionBuild, OnlyMovesPlacementsWhenTheMeshIsThere) {
  Put("ab");
  Build();
  const auto before = *session_.Built();
  Put("c");  // and with it the default places of "a" and "b" move
  ASSERT_THAT(session_.SetPlacements({}, ""), Succeeds());
  EXPECT_NE(Revision(), before->revision());
  ASSERT_THAT(session_.DeleteShape("c"), Succeeds());
  EXPECT_EQ(Build().state, BuildState::kSucceeded);
  EXPECT_EQ(Revision(), before->revision());
  EXPECT_EQ(&(*session_.Built())->mesh(), &before->mesh());
}

TEST_F(SessionBuild, AsksForThePlaceOfADrawingThatCameLater) {
  Put("ab");
  ASSERT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(3, 0)}}, ""), Succeeds());
  Put("c");
  EXPECT_THAT(session_.StartBuild(kRequest, pool_),
              FailsWith(ErrorCode::kInvalidOption, "placements['c']"));
  ASSERT_THAT(
      session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(3, 0)}, {"c", Point(0, 3)}}, ""),
      Succeeds());
  EXPECT_EQ(Build().state, BuildState::kSucceeded);
}

TEST_F(SessionBuild, FollowsTheMarks) {
  Put("ab");
  const Point in_a = CreatureRing(0.0).row(10);
  const Point in_b = CreatureRing(0.1).row(12);
  ASSERT_THAT(session_.SetCorrespondences({{{"a", in_a}, {"b", in_b}}}, ""), Succeeds());
  ASSERT_EQ(Build().state, BuildState::kSucceeded);
  const auto space = *session_.Built();
  ASSERT_EQ(space->mesh().landmarks.size(), 1u);
  const int vertex = space->mesh().landmarks[0];
  const double limit = 0.05 * 200;
  EXPECT_LT((Point(space->mesh().poses[0].row(vertex)) - in_a).norm(), limit);
  EXPECT_LT((Point(space->mesh().poses[1].row(vertex)) - in_b).norm(), limit);
}

TEST_F(SessionBuild, EndsWithItsSession) {
  Put("ab");
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  session_.Close();
  EXPECT_EQ(session_.LatestBuild()->Status().state, BuildState::kCancelled);
}

TEST(SessionAlone, MayGoBeforeItsBuildEnds) {
  auto session =
      std::make_unique<Session>("tux", "", std::map<std::string, std::string>(), Limits());
  ASSERT_THAT(session->PutShape("a", CreaturePolygon(0), false), Succeeds());
  BuildPool idle(WithWorkers(0));
  ASSERT_THAT(session->StartBuild({}, idle), Succeeds());
  const auto job = session->LatestBuild();
  session.reset();
  job->Run(std::chrono::minutes(1));
  EXPECT_EQ(job->Status().state, BuildState::kSucceeded);
}

TEST_F(SessionBuild, BlendsAndIsEditedWhileItBuilds) {
  Put("ab");
  Build();
  std::atomic<bool> stop = false;
  std::atomic<int> frames = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 2; ++i) {
    threads.emplace_back([&] {
      // Builds run at low priority, so readers pause to let them.
      for (; !stop; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
        const auto space = session_.Built();
        ASSERT_THAT(space, Succeeds());
        const auto frame = (*space)->Blend({Point(0.1, 0.2), {}, 0.0});
        ASSERT_THAT(frame, Succeeds());
        EXPECT_EQ(frame->vertices.rows(), (*space)->mesh().num_vertices());
        EXPECT_EQ(frame->weights.size(), std::ssize((*space)->drawings()));
        ++frames;
      }
    });
  }
  threads.emplace_back([&] {
    for (; !stop; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      const SessionView view = session_.View();
      EXPECT_EQ(view.placements.size(), view.shape_ids.size());
      EXPECT_GE(view.build->sequence, 1);
    }
  });
  for (int round = 0; round < 6; ++round) {
    ASSERT_THAT(session_.PutShape("b", CreaturePolygon(0.1 + 0.05 * round), true), Succeeds());
    Put(round % 2 == 0 ? "c" : "a");
    ASSERT_THAT(session_.StartBuild(kRequest, pool_), Succeeds());
    if (round % 3 == 1) session_.LatestBuild()->Cancel();
    if (round % 2 == 1) {
      ASSERT_THAT(session_.DeleteShape("c"), Succeeds());
      ASSERT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(1 + round, 0)}}, ""),
                  Succeeds());
      ASSERT_THAT(session_.SetPlacements({}, ""), Succeeds());
    }
  }
  EXPECT_EQ(Build().state, BuildState::kSucceeded);
  stop = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(frames, 0);
  EXPECT_EQ((*session_.Built())->drawings().size(), 2u);
}

TEST_F(SessionBuild, IsStartedByManyCallersAtOnceAsOneBuild) {
  Put("ab");
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::set<std::string> ids;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      const auto status = session_.StartBuild(kRequest, pool_);
      ASSERT_THAT(status, Succeeds());
      const std::lock_guard lock(mutex);
      ids.insert(status->id);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_EQ(EndOf(*session_.LatestBuild()).state, BuildState::kSucceeded);
}

TEST_F(SessionBuild, IsDeletedWhileItBuilds) {
  Put("abc");
  ASSERT_THAT(session_.StartBuild(kRequest, idle_), Succeeds());
  const auto job = session_.LatestBuild();
  std::binary_semaphore running(0), go_on(0);
  bool met = false;
  job->Watch([&](const BuildStatus& status) {
    if (met || status.state != BuildState::kRunning) return;
    met = true;  // holds the build until the session is gone
    running.release();
    go_on.acquire();
  });
  std::thread worker([&] { job->Run(std::chrono::minutes(1)); });
  running.acquire();
  session_.Close();
  go_on.release();
  worker.join();
  EXPECT_EQ(job->Status().state, BuildState::kCancelled);
  EXPECT_THAT(session_.StartBuild(kRequest, pool_), FailsWith(ErrorCode::kSessionNotFound));
}

}  // namespace
}  // namespace posespace
