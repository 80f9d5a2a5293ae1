// SPDX-License-Identifier: Apache-2.0
#include "rpc/live_streams.h"

#include <gmock/gmock.h>

#include <array>

#include "tests/support/fails_with.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;

class Stream final : public LiveStream {
 public:
  void Beat(std::chrono::steady_clock::time_point) override { ++beats; }
  void Drain(std::chrono::milliseconds grace) override { drained = grace; }

  int beats = 0;
  std::chrono::milliseconds drained{-1};
};

TEST(LiveStreams, AddsAsManyAsTheLimitAndAgainWhenOneHasGone) {
  LiveStreams streams(2);
  Stream a, b, c;
  EXPECT_THAT(streams.Add(&a), Succeeds());
  EXPECT_THAT(streams.Add(&b), Succeeds());
  EXPECT_THAT(streams.Add(&c), FailsWith(ErrorCode::kStreamLimit));
  EXPECT_EQ(streams.count(), 2u);
  streams.Remove(&a);
  EXPECT_THAT(streams.Add(&c), Succeeds());
}

TEST(LiveStreams, BeatsEachOnceInFour) {
  LiveStreams streams(10);
  std::array<Stream, 10> all;
  for (Stream& stream : all) EXPECT_THAT(streams.Add(&stream), Succeeds());
  for (int k = 0; k < 4; ++k) streams.Beat({});
  for (const Stream& stream : all) EXPECT_EQ(stream.beats, 1);
}

TEST(LiveStreams, TellsEveryStreamThatTheServiceEndsAndTakesNoMore) {
  LiveStreams streams(10);
  std::array<Stream, 6> all;
  for (Stream& stream : all) EXPECT_THAT(streams.Add(&stream), Succeeds());
  streams.Drain(3s);
  for (const Stream& stream : all) EXPECT_EQ(stream.drained, 3s);
  Stream late;
  EXPECT_THAT(streams.Add(&late), FailsWith(ErrorCode::kDraining));
}

}  // namespace
}  // namespace posespace
