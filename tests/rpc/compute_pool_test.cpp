// SPDX-License-Identifier: Apache-2.0
#include "rpc/compute_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <vector>

namespace posespace {
namespace {

TEST(ComputePool, TakesAsManyJobsAsItHasRoomForAndNoMore) {
  std::promise<void> gate, started;
  const std::shared_future<void> opened(gate.get_future());
  ComputePool pool(/*threads=*/1, /*capacity=*/2, /*niceness=*/0);
  ASSERT_TRUE(pool.TryPost([&] {
    started.set_value();
    opened.wait();
  }));
  started.get_future().wait();  // at work: it waits no longer
  EXPECT_TRUE(pool.TryPost([] {}));
  EXPECT_TRUE(pool.TryPost([] {}));
  EXPECT_FALSE(pool.TryPost([] {}));
  std::promise<void> posted;
  pool.Post([&] { posted.set_value(); });  // a stream's job is always taken
  gate.set_value();
  posted.get_future().wait();
}

TEST(ComputePool, WorksInTheOrderOfPosting) {
  std::vector<int> done;
  {
    ComputePool pool(/*threads=*/1, /*capacity=*/100, /*niceness=*/5);
    for (int k = 0; k < 100; ++k) pool.Post([&done, k] { done.push_back(k); });
  }
  ASSERT_EQ(done.size(), 100u);
  for (int k = 0; k < 100; ++k) EXPECT_EQ(done[static_cast<std::size_t>(k)], k);
}

TEST(ComputePool, FinishesWhatWasPostedBeforeItEnds) {
  std::atomic<int> done{0};
  {
    ComputePool pool(/*threads=*/4, /*capacity=*/1'000, /*niceness=*/0);
    for (int k = 0; k < 1'000; ++k) {
      EXPECT_TRUE(pool.TryPost([&] { ++done; }));
    }
  }
  EXPECT_EQ(done, 1'000);
}

}  // namespace
}  // namespace posespace
