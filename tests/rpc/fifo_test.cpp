// SPDX-License-Identifier: Apache-2.0
#include "rpc/fifo.h"

#include <gmock/gmock.h>

#include <deque>
#include <memory>
#include <random>

#include "tests/interpolation/counted_allocations.h"

namespace posespace {
namespace {

TEST(Fifo, DoesWhatADequeDoes) {
  Fifo<int> fifo;
  std::deque<int> expected;
  std::mt19937 random(1);
  for (int k = 0; k < 5'000; ++k) {
    const unsigned turn = random() % 100;
    if (turn < 50) {
      fifo.push_back(k);
      expected.push_back(k);
    } else if (turn < 98 && !expected.empty()) {
      EXPECT_EQ(fifo.pop_front(), expected.front());
      expected.pop_front();
    } else if (turn >= 98) {
      const std::size_t count = random() % 3;
      fifo.shorten(count);
      while (expected.size() > count) expected.pop_back();
    }
    ASSERT_EQ(fifo.size(), expected.size());
    ASSERT_EQ(fifo.empty(), expected.empty());
    for (std::size_t j = 0; j < expected.size(); ++j) ASSERT_EQ(fifo[j], expected[j]);
    if (expected.empty()) continue;
    EXPECT_EQ(fifo.front(), expected.front());
    EXPECT_EQ(fifo.back(), expected.back());
  }
}

TEST(Fifo, AllocatesNothingWhileItsLengthStays) {
  Fifo<std::unique_ptr<int>> fifo;
  for (int k = 0; k < 5; ++k) fifo.push_back(nullptr);
  for (int k = 0; k < 20; ++k) {
    fifo.push_back(nullptr);
    fifo.pop_front();
  }
  const int before = CountedAllocations();
  for (int k = 0; k < 1'000; ++k) {
    fifo.push_back(nullptr);
    fifo.pop_front();
  }
  EXPECT_EQ(CountedAllocations(), before);
}

}  // namespace
}  // namespace posespace
