// SPDX-License-Identifier: Apache-2.0
#include "rpc/message_bytes.h"

#include <gmock/gmock.h>

#include <cstddef>
#include <cstring>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "posespace/v1/pose_service.pb.h"
#include "tests/interpolation/counted_allocations.h"

namespace posespace {
namespace {

TEST(MessageBytes, HoldsAMessageAsItTravels) {
  v1::PlayResponse message;
  message.mutable_bound()->set_revision("1234");
  EXPECT_EQ(MessageBytes(message).view(), message.SerializeAsString());
}

TEST(MessageBytes, MayBeOfNothing) {
  EXPECT_EQ(MessageBytes().size(), 0u);
  EXPECT_EQ(MessageBytes(v1::PlayResponse()).size(), 0u);
  EXPECT_EQ(MessageBytes(std::size_t{0}).size(), 0u);
}

TEST(MessageBytes, UsesMemoryAgain) {
  { const MessageBytes first(100'000); }
  const int before = CountedAllocations();
  for (int k = 0; k < 10; ++k) {
    MessageBytes again(90'000 + k);
    MessageBytes::Return(std::move(again).Release());
  }
  EXPECT_EQ(CountedAllocations(), before);
}

TEST(MessageBytes, NeverGivesTheSameMemoryTwice) {
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([thread] {
      std::mt19937 random(static_cast<unsigned>(thread));
      std::vector<std::pair<MessageBytes, char>> held;
      for (int k = 0; k < 2'000; ++k) {
        const auto mark = static_cast<char>(random());
        MessageBytes bytes(random() % 3'000 + 1);
        std::memset(bytes.data(), mark, bytes.size());
        held.emplace_back(std::move(bytes), mark);
        if (held.size() < 8) continue;
        const auto& [oldest, its_mark] = held.front();
        EXPECT_EQ(oldest.view(), std::string(oldest.size(), its_mark));
        held.erase(held.begin());
      }
    });
  }
}

}  // namespace
}  // namespace posespace
