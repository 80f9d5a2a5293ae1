// SPDX-License-Identifier: Apache-2.0
#include "session/build_pool.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <semaphore>
#include <vector>

#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

Limits PoolLimits(int workers, int queue) {
  Limits limits;
  limits.concurrent_builds = workers;
  limits.build_queue = queue;
  return limits;
}

// A job and its end, to wait for.
struct Watched {
  explicit Watched(const std::string& id, BuildInputs inputs = CreatureInputs(1))
      : job(std::make_shared<BuildJob>(id, std::move(inputs), nullptr)) {
    job->Watch([this](const BuildStatus& status) {
      if (status.state == BuildState::kRunning && !was_running) {
        was_running = true;
        running.release();
      }
      if (status.ended()) ended.release();
    });
  }
  bool was_running = false;
  std::binary_semaphore running{0}, ended{0};
  std::shared_ptr<BuildJob> job;
};

TEST(BuildPool, BuildsWhatIsSubmitted) {
  Watched first("1"), second("2"), third("3");
  BuildPool pool(PoolLimits(2, 8));
  for (Watched* watched : {&first, &second, &third}) {
    ASSERT_THAT(pool.Submit(watched->job), Succeeds());
  }
  for (Watched* watched : {&first, &second, &third}) {
    watched->ended.acquire();
    EXPECT_EQ(watched->job->Status().state, BuildState::kSucceeded);
  }
}

TEST(BuildPool, StartsJobsInTheOrderTheyCame) {
  std::vector<std::string> order;  // by one worker, read after it ended
  {
    std::vector<std::unique_ptr<Watched>> jobs;
    BuildPool pool(PoolLimits(1, 8));
    for (const char* id : {"1", "2", "3", "4"}) {
      jobs.push_back(std::make_unique<Watched>(id));
      jobs.back()->job->Watch([&order](const BuildStatus& status) {
        if (status.ended()) order.push_back(status.id);
      });
      ASSERT_THAT(pool.Submit(jobs.back()->job), Succeeds());
    }
    for (auto& job : jobs) job->ended.acquire();
    pool.Stop();
  }
  EXPECT_EQ(order, (std::vector<std::string>{"1", "2", "3", "4"}));
}

TEST(BuildPool, RefusesMoreThanItsQueueHolds) {
  Watched first("1"), second("2"), third("3");
  BuildPool pool(PoolLimits(0, 2));
  EXPECT_THAT(pool.Submit(first.job), Succeeds());
  EXPECT_THAT(pool.Submit(second.job), Succeeds());
  EXPECT_THAT(pool.Submit(third.job), FailsWith(ErrorCode::kBuildQueueFull));
  first.job->Cancel();
  EXPECT_THAT(pool.Submit(third.job), Succeeds()) << "a cancelled job leaves the queue";
}

TEST(BuildPool, CancelsWhatIsQueuedAndRunningWhenItStops) {
  Watched running("1", LongInputs()), queued("2");
  BuildPool pool(PoolLimits(1, 8));
  ASSERT_THAT(pool.Submit(running.job), Succeeds());
  ASSERT_THAT(pool.Submit(queued.job), Succeeds());
  running.running.acquire();
  pool.Stop();
  EXPECT_EQ(running.job->Status().state, BuildState::kCancelled);
  EXPECT_EQ(queued.job->Status().state, BuildState::kCancelled);
  EXPECT_THAT(pool.Submit(std::make_shared<BuildJob>("3", CreatureInputs(1), nullptr)),
              FailsWith(ErrorCode::kDraining));
  pool.Stop();
}

TEST(BuildPool, FailsABuildThatTakesTooLongAndGoesOn) {
  Limits limits = PoolLimits(1, 8);
  limits.build_timeout = std::chrono::seconds(0);
  Watched first("1"), second("2");
  BuildPool pool(limits);
  ASSERT_THAT(pool.Submit(first.job), Succeeds());
  ASSERT_THAT(pool.Submit(second.job), Succeeds());
  first.ended.acquire();
  second.ended.acquire();
  EXPECT_EQ(second.job->Status().error->code, ErrorCode::kBuildTimeout);
}

TEST(BuildPool, WorksAtTheLowestPriority) {
  const auto priority_of_this_thread = [] {
    return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
  };
  const int own = priority_of_this_thread();
  int priority = 0;
  std::binary_semaphore done(0);
  const auto note = [&](const BuildStatus&) -> Result<void> {
    priority = priority_of_this_thread();
    done.release();
    return {};
  };
  const auto job = std::make_shared<BuildJob>("1", CreatureInputs(1), note);
  BuildPool pool(PoolLimits(1, 1));
  ASSERT_THAT(pool.Submit(job), Succeeds());
  done.acquire();
  EXPECT_EQ(priority, 19);
  EXPECT_EQ(priority_of_this_thread(), own);
}

}  // namespace
}  // namespace posespace
