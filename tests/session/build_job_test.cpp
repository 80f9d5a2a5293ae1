// SPDX-License-Identifier: Apache-2.0
#include "session/build_job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <mutex>
#include <semaphore>
#include <stdexcept>
#include <thread>

#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kAmple{600'000};

// What a listener heard.
class Record {
 public:
  BuildJob::Listener Listener() {
    return [this](const BuildStatus& status) {
      const std::lock_guard lock(mutex_);
      statuses_.push_back(status);
    };
  }
  std::vector<BuildStatus> Statuses() const {
    const std::lock_guard lock(mutex_);
    return statuses_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<BuildStatus> statuses_;
};

TEST(BuildJob, BuildsAndTellsItsStoryInOrder) {
  std::vector<BuildState> at_done;
  Record record;
  BuildJob job("7", CreatureInputs(3), [&](const BuildStatus& status) -> Result<void> {
    at_done.push_back(status.state);
    EXPECT_FALSE(record.Statuses().back().ended()) << "watchers hear of the end after Done";
    return {};
  });
  EXPECT_EQ(job.revision(), RevisionDigest(CreatureInputs(3)));
  job.Watch(record.Listener());
  job.Run(kAmple);

  EXPECT_THAT(at_done, testing::ElementsAre(BuildState::kSucceeded));
  const auto heard = record.Statuses();
  ASSERT_GE(heard.size(), 3u);
  EXPECT_EQ(heard.front().state, BuildState::kQueued);
  EXPECT_GE(heard.front().sequence, 1);
  EXPECT_EQ(heard.back().state, BuildState::kSucceeded);
  EXPECT_EQ(heard.back().fraction, 1.0);
  EXPECT_EQ(heard.back().stage, "weights");
  ASSERT_NE(heard.back().pose_space, nullptr);
  EXPECT_EQ(heard.back().pose_space->revision(), job.revision());
  for (std::size_t i = 1; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].id, "7");
    EXPECT_GT(heard[i].sequence, heard[i - 1].sequence);
    EXPECT_GE(heard[i].fraction, heard[i - 1].fraction);
    EXPECT_GE(heard[i].state, heard[i - 1].state);
  }
  std::vector<std::string> stages;
  for (const BuildStatus& status : heard) {
    if (!status.stage.empty() && (stages.empty() || stages.back() != status.stage)) {
      stages.push_back(status.stage);
    }
  }
  EXPECT_THAT(stages, testing::ElementsAre("matching", "simplification", "triangulation",
                                           "improvement", "alignment", "weights"));
}

TEST(BuildJob, TellsWhyItFailed) {
  BuildInputs inputs = CreatureInputs(2);
  inputs.placements = PointsOf("1 1, 1 1");
  BuildState at_done = BuildState::kQueued;
  BuildJob job("1", inputs, [&](const BuildStatus& status) -> Result<void> {
    at_done = status.state;
    return {};
  });
  job.Run(kAmple);
  EXPECT_EQ(at_done, BuildState::kFailed);
  const BuildStatus status = job.Status();
  EXPECT_EQ(status.state, BuildState::kFailed);
  ASSERT_TRUE(status.error.has_value());
  EXPECT_EQ(status.error->code, ErrorCode::kPlacementsCoincide);
  EXPECT_EQ(status.pose_space, nullptr);
}

TEST(BuildJob, FailsWhenNobodyCanTakeWhatItBuilt) {
  BuildJob job("1", CreatureInputs(2), [](const BuildStatus&) -> Result<void> {
    return Error{ErrorCode::kStoreUnavailable, "the disk is full", {}};
  });
  job.Run(kAmple);
  EXPECT_EQ(job.Status().state, BuildState::kFailed);
  ASSERT_TRUE(job.Status().error.has_value());
  EXPECT_EQ(job.Status().error->code, ErrorCode::kStoreUnavailable);
  EXPECT_EQ(job.Status().pose_space, nullptr);
  EXPECT_EQ(job.Status().summary, nullptr);
}

TEST(BuildJob, FailsWhenItsLimitIsOver) {
  BuildJob job("1", CreatureInputs(2), nullptr);
  job.Run(milliseconds(0));
  ASSERT_TRUE(job.Status().error.has_value());
  EXPECT_EQ(job.Status().state, BuildState::kFailed);
  EXPECT_EQ(job.Status().error->code, ErrorCode::kBuildTimeout);
  EXPECT_FALSE(job.cancelled());
}

TEST(BuildJob, IsStoppedAtItsLimitLongBeforeItWouldEnd) {
  BuildJob job("1", LongInputs(), nullptr);
  job.Run(milliseconds(30));
  ASSERT_TRUE(job.Status().error.has_value());
  EXPECT_EQ(job.Status().error->code, ErrorCode::kBuildTimeout);
  EXPECT_LT(job.Status().fraction, 1.0);
}

TEST(BuildJob, CancelledWhileQueuedEndsAtOnceAndIsNeverBuilt) {
  int done = 0;
  BuildJob job("1", CreatureInputs(2), [&](const BuildStatus& status) -> Result<void> {
    ++done;
    EXPECT_EQ(status.state, BuildState::kCancelled);
    return {};
  });
  Record record;
  job.Watch(record.Listener());
  job.Cancel();
  EXPECT_TRUE(job.ended());
  EXPECT_TRUE(job.cancelled());
  job.Cancel();
  job.Run(kAmple);
  EXPECT_EQ(done, 1);
  ASSERT_EQ(record.Statuses().size(), 2u);
  EXPECT_EQ(record.Statuses()[1].state, BuildState::kCancelled);
  EXPECT_EQ(record.Statuses()[1].error->code, ErrorCode::kCancelled);
}

TEST(BuildJob, CancelledWhileRunningEndsCancelled) {
  BuildJob job("1", LongInputs(), nullptr);
  std::binary_semaphore running(0), go_on(0);
  bool met = false;
  job.Watch([&](const BuildStatus& status) {
    if (met || status.state != BuildState::kRunning) return;
    met = true;  // holds the build until it has been cancelled
    running.release();
    go_on.acquire();
  });
  std::thread worker([&] { job.Run(kAmple); });
  running.acquire();
  job.Cancel();
  EXPECT_TRUE(job.cancelled());
  EXPECT_FALSE(job.ended());
  go_on.release();
  worker.join();
  EXPECT_EQ(job.Status().state, BuildState::kCancelled);
  EXPECT_EQ(job.Status().pose_space, nullptr);
}

TEST(BuildJob, StaysAsItIsWhenCancelledAfterItsEnd) {
  BuildJob job("1", CreatureInputs(2), nullptr);
  job.Run(kAmple);
  const auto sequence = job.Status().sequence;
  job.Cancel();
  EXPECT_EQ(job.Status().state, BuildState::kSucceeded);
  EXPECT_EQ(job.Status().sequence, sequence);
  EXPECT_FALSE(job.cancelled());
}

TEST(BuildJob, FailsWhenWhatItBuiltCannotBeUsed) {
  BuildJob job("1", CreatureInputs(1),
               [](const BuildStatus&) -> Result<void> { throw std::runtime_error("no room"); });
  job.Run(kAmple);
  EXPECT_EQ(job.Status().state, BuildState::kFailed);
  ASSERT_TRUE(job.Status().error.has_value());
  EXPECT_EQ(job.Status().error->code, ErrorCode::kInternal);
  EXPECT_EQ(job.Status().pose_space, nullptr);
}

TEST(BuildJob, OnlyMovesPlacementsWhenTheMeshIsThere) {
  const auto built = PoseSpace::Build(CreatureInputs(2));
  ASSERT_THAT(built, Succeeds());
  BuildInputs moved = CreatureInputs(2);
  moved.placements = PointsOf("0 0, 5 0");
  BuildJob job("1", moved, nullptr, *built);
  job.Run(kAmple);
  ASSERT_EQ(job.Status().state, BuildState::kSucceeded);
  EXPECT_EQ(&job.Status().pose_space->mesh(), &(*built)->mesh());
  EXPECT_EQ(job.Status().pose_space->revision(), RevisionDigest(moved));

  BuildInputs other = moved;
  other.options.simplification.tolerance = 0.05;
  BuildJob other_job("2", other, nullptr, *built);
  other_job.Run(kAmple);
  ASSERT_EQ(other_job.Status().state, BuildState::kSucceeded);
  EXPECT_NE(&other_job.Status().pose_space->mesh(), &(*built)->mesh());
}

TEST(BuildJob, MayHaveSucceededBeforeItWasAskedFor) {
  const auto built = PoseSpace::Build(CreatureInputs(1));
  ASSERT_THAT(built, Succeeds());
  BuildJob job("3", *built);
  EXPECT_TRUE(job.ended());
  EXPECT_EQ(job.revision(), (*built)->revision());
  job.Cancel();
  job.Run(kAmple);
  EXPECT_EQ(job.Status().state, BuildState::kSucceeded);
  EXPECT_EQ(job.Status().pose_space, *built);
}

TEST(BuildJob, NumbersItsChangesOnFromTheBuildBefore) {
  const auto changes = std::make_shared<ChangeCounter>(0);
  BuildJob first("1", CreatureInputs(1), nullptr, nullptr, changes);
  first.Run(kAmple);
  BuildJob second("2", CreatureInputs(1), nullptr, nullptr, changes);
  EXPECT_GT(second.Status().sequence, first.Status().sequence);
}

TEST(BuildJob, TellsALateWatcherHowItEnded) {
  BuildJob job("1", CreatureInputs(1), nullptr);
  job.Run(kAmple);
  Record record;
  job.Unwatch(job.Watch(record.Listener()));
  ASSERT_EQ(record.Statuses().size(), 1u);
  EXPECT_EQ(record.Statuses()[0].state, BuildState::kSucceeded);
}

TEST(BuildJob, TellsNothingAfterUnwatch) {
  BuildJob job("1", CreatureInputs(1), nullptr);
  Record record;
  const auto token = job.Watch(record.Listener());
  job.Unwatch(token);
  job.Unwatch(token);
  job.Run(kAmple);
  EXPECT_EQ(record.Statuses().size(), 1u);
}

TEST(BuildJob, LetsAListenerEndWatchesItsOwnIncluded) {
  BuildJob job("1", CreatureInputs(1), nullptr);
  Record later;
  std::int64_t own = 0, others = 0;
  int heard = 0;
  own = job.Watch([&](const BuildStatus& status) {
    ++heard;
    if (status.state != BuildState::kRunning) return;
    job.Unwatch(own);
    job.Unwatch(others);
  });
  others = job.Watch(later.Listener());
  job.Run(kAmple);
  EXPECT_EQ(heard, 2);
  EXPECT_EQ(later.Statuses().size(), 1u);
}

TEST(BuildJob, EndsAWatchOnlyAfterTheCallThatIsRunning) {
  BuildJob job("1", CreatureInputs(1), nullptr);
  std::binary_semaphore in_call(0);
  std::atomic<bool> call_ended = false;
  const auto token = job.Watch([&](const BuildStatus& status) {
    if (status.state != BuildState::kRunning || call_ended) return;
    in_call.release();
    std::this_thread::sleep_for(milliseconds(30));
    call_ended = true;
  });
  std::thread worker([&] { job.Run(kAmple); });
  in_call.acquire();
  job.Unwatch(token);
  EXPECT_TRUE(call_ended);
  worker.join();
}

TEST(BuildJob, TellsItsEndToManyWatchersThatComeAndGo) {
  BuildJob job("1", CreatureInputs(3), nullptr);
  std::atomic<int> ends = 0;
  std::vector<std::thread> watchers;
  for (int i = 0; i < 8; ++i) {
    watchers.emplace_back([&, i] {
      for (int k = 0; k < 20; ++k) {
        std::int64_t last = 0;
        job.Unwatch(job.Watch([&last](const BuildStatus& status) { last = status.sequence; }));
        EXPECT_GE(last, 1);
      }
      std::binary_semaphore ended(0);
      std::int64_t last = 0;
      const auto token = job.Watch([&](const BuildStatus& status) {
        EXPECT_GT(status.sequence, last) << i;
        last = status.sequence;
        if (status.ended()) ended.release();
      });
      ended.acquire();
      job.Unwatch(token);
      ++ends;
    });
  }
  job.Run(kAmple);
  for (std::thread& watcher : watchers) watcher.join();
  EXPECT_EQ(ends, 8);
}

}  // namespace
}  // namespace posespace
