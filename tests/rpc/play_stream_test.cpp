// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_stream.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/rpc/built_session.h"
#include "tests/rpc/play_fixture.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/flaky_store.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using Clock = PlayStream::Clock;

TEST_F(Play, BeginsWithTheLimits) {
  const auto welcome = Take().welcome();
  EXPECT_EQ(welcome.max_slots(), 64u);
  EXPECT_EQ(welcome.max_items(), 256u);
  EXPECT_EQ(welcome.max_in_flight(), 4u);
}

TEST_F(Play, SaysWhatASlotIsBoundTo) {
  Say(Bind(63));
  const auto bound = TakeAll().back().bound();
  EXPECT_EQ(bound.slot(), 63u);
  EXPECT_EQ(bound.reason(), "");
  EXPECT_EQ(bound.revision(), Revision());
  EXPECT_EQ(bound.vertex_count(), Vertices());
  EXPECT_THAT(bound.shape_ids(), ::testing::ElementsAre("wide", "tall"));
}

TEST_F(Play, SaysWhyASlotCannotBeBound) {
  ASSERT_TRUE(sessions_.registry().Create({"raw", "", {}, "raw"}));
  const std::vector<std::pair<v1::PlayRequest, std::string>> cases = {
      {Bind(0, "nobody"), "SESSION_NOT_FOUND"},
      {Bind(0, ""), "INVALID_ID"},
      {Bind(0, "raw"), "SESSION_NOT_BUILT"},
      {Bind(0, "cell", "another"), "REVISION_NOT_FOUND"},
      {Bind(64), "SLOT_LIMIT"},
      {Bind(std::numeric_limits<std::uint32_t>::max()), "SLOT_LIMIT"}};
  for (const auto& [request, reason] : cases) {
    Say(request);
    const auto bound = TakeAll().back().bound();
    EXPECT_EQ(bound.reason(), reason);
    EXPECT_NE(bound.error_message(), "");
    EXPECT_EQ(bound.slot(), request.bind().slot());
  }
  EXPECT_FALSE(wire_.finished);
}

TEST_F(Play, AnswersEachItemInOrder) {
  BindSlot0();
  Say(Tick(7, {0, 0, 0}));
  const auto result = TakeAll().back().frame_result();
  EXPECT_EQ(result.frame_id(), 7u);
  ASSERT_EQ(result.items_size(), 3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(result.items(k).tag(), 101u + k);
    EXPECT_EQ(result.items(k).reason(), "");
    EXPECT_EQ(result.items(k).frame().vertices().size(), 8u * Vertices());
    EXPECT_EQ(result.items(k).frame().weights_size(), 0);
  }
}

TEST_F(Play, AnswersAFrameWithoutItemsByOneWithoutItems) {
  Say(Tick(1, {}));
  EXPECT_EQ(TakeAll().back().frame_result().frame_id(), 1u);
}

TEST_F(Play, ReturnsWeightsWhenAsked) {
  BindSlot0();
  auto tick = Tick(1, {0}, 1.0);
  tick.mutable_tick()->set_with_weights(true);
  Say(tick);
  const auto frame = TakeAll().back().frame_result().items(0).frame();
  ASSERT_EQ(frame.weights_size(), 2);
  EXPECT_NEAR(frame.weights(1), 1.0, 1e-9);
  EXPECT_EQ(frame.texture_weights_size(), 2);
}

TEST_F(Play, SendsVerticesInHalfTheBytesWhenAsked) {
  BindSlot0();
  Say(Tick(1, {0}));
  const v1::Frame whole = TakeAll().back().frame_result().items(0).frame();
  auto tick = Tick(2, {0});
  tick.mutable_tick()->set_vertex_format(v1::VERTEX_FORMAT_INT16);
  Say(tick);
  const v1::Frame half = TakeAll().back().frame_result().items(0).frame();
  EXPECT_FALSE(whole.has_quantized());
  EXPECT_EQ(half.vertices(), "");
  EXPECT_EQ(half.quantized().values().size(), 4u * Vertices());

  std::vector<float> vertices(2 * Vertices());
  std::vector<std::int16_t> steps(vertices.size());
  std::memcpy(vertices.data(), whole.vertices().data(), whole.vertices().size());
  std::memcpy(steps.data(), half.quantized().values().data(), half.quantized().values().size());
  const auto& grid = half.quantized();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const float center = k % 2 == 0 ? grid.center_x() : grid.center_y();
    ASSERT_NEAR(center + grid.step() * steps[k], vertices[k], 0.51 * grid.step() + 5e-5) << k;
  }
}

TEST_F(Play, RefusesTheItemsOfATickInAnUnknownFormat) {
  BindSlot0();
  auto tick = Tick(1, {0, 0});
  tick.mutable_tick()->set_vertex_format(static_cast<v1::VertexFormat>(3));
  Say(tick);
  const auto result = TakeAll().back().frame_result();
  ASSERT_EQ(result.items_size(), 2);
  for (const auto& item : result.items()) EXPECT_EQ(item.reason(), "INVALID_OPTION");
  EXPECT_FALSE(wire_.finished);
}

TEST_F(Play, AnswersItemsOfManyKindsAsEachAlone) {
  BindSlot0();
  auto together = Tick(1, std::vector<std::uint32_t>(40, 0));
  for (int k = 0; k < 40; ++k) {
    auto& query = *together.mutable_tick()->mutable_items(k)->mutable_query();
    query.mutable_at()->set_y(0.02 * k);
    if (k % 3 == 1) query.mutable_options()->set_refits(k % 4);
    if (k % 7 == 2) query.mutable_options()->set_method(v1::BLEND_METHOD_LINEAR);
    if (k % 5 == 3) {
      query.mutable_weights()->add_values(0.3);
      query.mutable_weights()->add_values(0.7);
    }
  }
  Say(together);
  const auto result = TakeAll().back().frame_result();
  ASSERT_EQ(result.items_size(), 40);
  for (int k = 0; k < 40; ++k) {
    auto alone = Tick(2, {});
    *alone.mutable_tick()->add_items() = together.tick().items(k);
    Say(alone);
    const auto expected = TakeAll().back().frame_result().items(0);
    EXPECT_EQ(result.items(k).SerializeAsString(), expected.SerializeAsString()) << k;
  }
}

TEST_F(Play, AllocatesNothingForAnItemOfASteadyStream) {
  BindSlot0();
  ExpectNoAllocationForAnItem();
}

// Once each message made the memory for the next one larger, until there was none.
TEST_F(Play, AnswersHundredsOfFramesReadByOtherThreads) {
  BindSlot0();
  const v1::PlayRequest tick = Tick(1, {0, 0}, 0.3);
  for (int k = 0; k < 300; ++k) {
    std::thread([&] { *std::exchange(wire_.reading, nullptr) = tick; }).join();
    stream_.OnRead(true);
    ASSERT_EQ(TakeAll().back().frame_result().items_size(), 2) << k;
  }
}

TEST_F(Play, KeepsOneAvatarsErrorFromEndingTheStream) {
  BindSlot0();
  auto tick = Tick(1, {0, 5, 0, 0, 0});
  auto& items = *tick.mutable_tick()->mutable_items();
  items[2].mutable_query()->mutable_at()->set_x(std::numeric_limits<double>::quiet_NaN());
  items[3].mutable_query()->mutable_weights()->add_values(1.0);
  items[4].clear_query();
  Say(tick);
  const auto result = TakeAll().back().frame_result();
  ASSERT_EQ(result.items_size(), 5);
  EXPECT_EQ(result.items(0).reason(), "");
  EXPECT_EQ(result.items(1).reason(), "SLOT_NOT_BOUND");
  EXPECT_EQ(result.items(2).reason(), "POSE_NOT_FINITE");
  EXPECT_EQ(result.items(3).reason(), "WEIGHTS_COUNT_MISMATCH");
  EXPECT_EQ(result.items(4).reason(), "INVALID_OPTION");
  for (int k = 1; k < 5; ++k) {
    EXPECT_FALSE(result.items(k).has_frame());
    EXPECT_NE(result.items(k).error_message(), "");
  }
  EXPECT_FALSE(wire_.finished);
  Say(Tick(2, {0}));
  EXPECT_EQ(TakeAll().back().frame_result().items(0).reason(), "");
}

TEST_F(Play, ForgetsAnUnboundSlot) {
  BindSlot0();
  Say(Unbind(0));
  Say(Unbind(9));
  Say(Tick(1, {0}));
  EXPECT_EQ(TakeAll().back().frame_result().items(0).reason(), "SLOT_NOT_BOUND");
}

TEST_F(Play, BindsASlotAnew) {
  ASSERT_TRUE(sessions_.registry().Create({"raw", "", {}, "raw"}));
  BindSlot0();
  Say(Bind(0, "raw"));
  EXPECT_EQ(TakeAll().back().bound().reason(), "SESSION_NOT_BUILT");
  Say(Tick(1, {0}));
  EXPECT_EQ(TakeAll().back().frame_result().items(0).reason(), "SLOT_NOT_BOUND");
  BindSlot0();
  Say(Tick(2, {0}));
  EXPECT_EQ(TakeAll().back().frame_result().items(0).reason(), "");
}

TEST_F(Play, BindsASessionInMemoryWithoutAskingForAnotherThread) {
  Say(Bind(0));
  EXPECT_FALSE(wire_.work);
  EXPECT_EQ(TakeAll().back().bound().reason(), "");
  EXPECT_EQ(wire_.loads, 0);
}

// A registry that has just been opened: the session is in the store alone.
struct StoredSession {
  StoredSession() {
    BuiltSession built({}, store);
    stored = Registry::Open({}, store).value();
  }
  const std::shared_ptr<FlakyStore> store = std::make_shared<FlakyStore>();
  std::unique_ptr<Registry> stored;
};

TEST(PlayOfAStoredSession, LoadsItOnAThreadThatMayWait) {
  const StoredSession session;
  Wire wire;
  PlayStream stream(*session.stored, Limits(), wire);
  stream.Start();
  const auto answer = [&] {
    const v1::PlayResponse message = *std::exchange(wire.writing, nullptr);
    stream.OnWritten(true);
    return message;
  };
  EXPECT_TRUE(answer().has_welcome());
  v1::PlayRequest bind;
  bind.mutable_bind()->set_session_id("cell");
  *std::exchange(wire.reading, nullptr) = bind;
  stream.OnRead(true);
  EXPECT_EQ(session.store->records_read, 0) << "the thread that read the message reads no disk";
  EXPECT_EQ(wire.writing, nullptr);
  EXPECT_EQ(wire.loads, 1);
  ASSERT_TRUE(std::exchange(wire.work, false));
  stream.Work();
  EXPECT_EQ(session.store->records_read, 1);
  EXPECT_EQ(answer().bound().reason(), "");
}

TEST_F(PlayOfAChangingSession, SaysBetweenTwoFramesThatARevisionHasChanged) {
  BindSlot0();
  Say(Tick(1, {0}));
  ASSERT_EQ(TakeAll().size(), 1u);
  const std::string before = Revision();
  sessions_.Put("tall", EllipseOf(30, 90));
  sessions_.Build();
  ASSERT_NE(Revision(), before);

  Say(Tick(2, {0}));
  const auto messages = TakeAll();
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].revision_changed().revision(), Revision());
  EXPECT_EQ(messages[0].revision_changed().vertex_count(), Vertices());
  EXPECT_EQ(messages[0].revision_changed().shape_ids_size(), 2);
  EXPECT_EQ(messages[1].frame_result().items(0).frame().vertices().size(), 8u * Vertices());
}

TEST_F(PlayOfAChangingSession, SaysThatARevisionHasChangedWithoutWaitingForAFrame) {
  BindSlot0();
  ASSERT_TRUE(
      sessions_.session().SetPlacements({{"wide", Point(0, 0)}, {"tall", Point(5, 5)}}, ""));
  stream_.Beat(Clock::now());
  EXPECT_EQ(Take().revision_changed().revision(), Revision());
  stream_.Beat(Clock::now());
  EXPECT_EQ(wire_.writing, nullptr) << "said twice";
}

TEST_F(PlayOfAChangingSession, KeepsAPinnedRevision) {
  const std::string pinned = Revision();
  Say(Bind(0, "cell", pinned));
  ASSERT_EQ(TakeAll().back().bound().revision(), pinned);
  ASSERT_TRUE(
      sessions_.session().SetPlacements({{"wide", Point(0, 0)}, {"tall", Point(0, 2)}}, ""));
  Say(Tick(1, {0}, 1.0));
  const auto messages = TakeAll();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].frame_result().items(0).reason(), "");
}

TEST_F(PlayOfAChangingSession, FreesTheSlotOfADeletedSession) {
  BindSlot0();
  ASSERT_TRUE(sessions_.registry().Delete("cell", ""));
  Say(Tick(1, {0}));
  const auto messages = TakeAll();
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].revision_changed().slot(), 0u);
  EXPECT_EQ(messages[0].revision_changed().revision(), "");
  EXPECT_EQ(messages[1].frame_result().items(0).reason(), "SLOT_NOT_BOUND");
}

TEST_F(Play, ReadsAheadNoFartherThanAllowed) {
  BindSlot0();
  for (int k = 0; k < 4; ++k) Say(Tick(k, {0}));
  EXPECT_EQ(wire_.reading, nullptr);
  // Answering does not make room, only the client's taking the answer does.
  while (wire_.work) LetWork();
  EXPECT_EQ(wire_.reading, nullptr);
  EXPECT_EQ(Take().frame_result().frame_id(), 0u);
  EXPECT_NE(wire_.reading, nullptr);
  Say(Tick(4, {0}));
  EXPECT_EQ(wire_.reading, nullptr);
  const auto rest = TakeAll();
  ASSERT_EQ(rest.size(), 4u);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(rest[k].frame_result().frame_id(), 1u + k);
}

TEST_F(Play, EndsWellWhenTheClientHasSaidAllAndGotItsAnswers) {
  BindSlot0();
  Say(Tick(1, {0}));
  Say(Tick(2, {0}));
  SayAll();
  EXPECT_FALSE(wire_.finished);
  EXPECT_EQ(TakeAll().size(), 2u);
  EXPECT_TRUE(wire_.finished);
  EXPECT_FALSE(wire_.error);
}

TEST_F(Play, EndsByAMessageThatMakesNoSenseAfterItsEarlierAnswers) {
  BindSlot0();
  Say(Tick(1, {0}));
  Say({});
  const auto messages = TakeAll();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].frame_result().frame_id(), 1u);
  EXPECT_TRUE(wire_.finished);
  EXPECT_EQ(wire_.error, ErrorCode::kProtocolBreach);
}

TEST_F(Play, TakesAsManyItemsAsItSaysAndEndsByMore) {
  BindSlot0();
  Say(Tick(1, std::vector<std::uint32_t>(256, 9)));
  EXPECT_EQ(TakeAll().back().frame_result().items_size(), 256);
  Say(Tick(2, std::vector<std::uint32_t>(257, 9)));
  TakeAll();
  EXPECT_EQ(wire_.error, ErrorCode::kProtocolBreach);
}

TEST_F(Play, EndsOnceWhenCancelledWhileItWorksWritesAndReads) {
  BindSlot0();
  Say(Tick(1, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(wire_.work);
  stream_.Drain(1s);
  ASSERT_NE(wire_.writing, nullptr);
  stream_.OnCancelled();
  EXPECT_FALSE(wire_.finished) << "a thread is still at work";
  LetWork();
  EXPECT_FALSE(wire_.finished) << "a message is still being written";
  wire_.writing = nullptr;
  stream_.OnWritten(false);
  EXPECT_TRUE(wire_.finished);
  EXPECT_EQ(wire_.error, ErrorCode::kCancelled);
  stream_.OnRead(false);
  stream_.OnCancelled();
  stream_.Beat(Clock::now() + 1h);
}

TEST_F(Play, HearsThatAWriteIsDoneWhileItIsStillBeingStarted) {
  BindSlot0();
  wire_.during_write = [&] { Take(); };
  Say(Tick(7, {0}));
  EXPECT_EQ(wire_.written.frame_result().frame_id(), 7u);
  EXPECT_EQ(wire_.writing, nullptr);
  EXPECT_NE(wire_.reading, nullptr) << "it listens on";
}

TEST_F(Play, FinishesAfterTheStartOfAReadThatACancellationOvertakes) {
  BindSlot0();
  wire_.during_read = [&] {
    stream_.OnCancelled();
    EXPECT_FALSE(wire_.finished) << "the read is still being started";
  };
  Say(Tick(7, {0}));
  EXPECT_FALSE(wire_.finished) << "the answer is being written";
  stream_.OnWritten(false);
  EXPECT_TRUE(wire_.finished);
}

TEST_F(Play, TheStarterOfAReadFinishesWhenAllElseHasEnded) {
  BindSlot0();
  wire_.during_write = [&] { Take(); };
  wire_.during_read = [&] {
    stream_.OnCancelled();
    EXPECT_FALSE(wire_.finished) << "the read is still being started";
  };
  Say(Tick(7, {0}));
  EXPECT_TRUE(wire_.finished);
  EXPECT_EQ(wire_.error, ErrorCode::kCancelled);
}

TEST_F(Play, EndsWhenTheClientVanishesDuringAWrite) {
  wire_.writing = nullptr;
  stream_.OnWritten(false);
  EXPECT_TRUE(wire_.finished);
  EXPECT_EQ(wire_.error, ErrorCode::kCancelled);
}

TEST_F(Play, GivesASignOfLifeAfterASilenceOnly) {
  BindSlot0();
  const auto now = Clock::now();
  stream_.Beat(now + 5s);
  EXPECT_EQ(wire_.writing, nullptr);
  stream_.Beat(now + 11s);
  ASSERT_NE(wire_.writing, nullptr);
  EXPECT_TRUE(Take().has_heartbeat());
}

TEST_F(Play, GivesNoSignsOfLifeToAReaderThatDoesNotTakeThem) {
  const auto now = Clock::now();
  for (int k = 1; k < 100; ++k) stream_.Beat(now + k * 11s);
  EXPECT_TRUE(Take().has_welcome());
  EXPECT_EQ(wire_.writing, nullptr);
}

TEST_F(Play, AnswersWhileItDrainsAndEndsWhenTheClientEnds) {
  BindSlot0();
  const auto now = Clock::now();
  stream_.Drain(1500ms, now);
  stream_.Drain(1500ms, now);
  Say(Tick(1, {0}));
  const auto messages = TakeAll();
  ASSERT_EQ(messages.size(), 2u) << "said once";
  EXPECT_EQ(messages[0].draining().stop_sending_in().seconds(), 1);
  EXPECT_EQ(messages[0].draining().stop_sending_in().nanos(), 500'000'000);
  EXPECT_EQ(messages[1].frame_result().items(0).reason(), "");
  stream_.Beat(now + 1s);
  EXPECT_FALSE(wire_.finished);
  SayAll();
  EXPECT_TRUE(wire_.finished);
  EXPECT_FALSE(wire_.error);
}

TEST_F(Play, DrainsWhenItIsOld) {
  const auto born = Clock::now();
  Wire wire;
  PlayStream stream(sessions_.registry(), {}, wire, born + 5s);
  stream.Start();
  const auto take = [&] {
    const v1::PlayResponse message = *std::exchange(wire.writing, nullptr);
    stream.OnWritten(true);
    return message;
  };
  EXPECT_TRUE(take().has_welcome());
  stream.Beat(born + 4s);
  EXPECT_EQ(wire.writing, nullptr);
  stream.Beat(born + 5s);
  EXPECT_EQ(take().draining().stop_sending_in().seconds(), PlayStream::kOldGrace.count());
  stream.Beat(born + 4s + PlayStream::kOldGrace);
  EXPECT_TRUE(take().has_heartbeat());
  EXPECT_FALSE(wire.finished);
  stream.Beat(born + 5s + PlayStream::kOldGrace);
  EXPECT_TRUE(wire.finished);
  EXPECT_EQ(wire.error, ErrorCode::kDraining);
}

TEST_F(Play, AServiceThatEndsShortensTheTimeOfAnOldStream) {
  const auto now = Clock::now();
  stream_.Drain(60s, now);
  stream_.Drain(1s, now);
  TakeAll();
  stream_.Beat(now + 1s);
  EXPECT_TRUE(wire_.finished);
}

TEST_F(Play, LatestOnlyDropsWhatALaterFrameAsksForAgain) {
  BindSlot0();
  const auto tagged = [](std::uint64_t frame_id, const std::vector<std::uint32_t>& tags) {
    v1::PlayRequest request = Tick(frame_id, std::vector<std::uint32_t>(tags.size(), 0));
    request.mutable_tick()->set_latest_only(true);
    for (int k = 0; k < request.tick().items_size(); ++k) {
      request.mutable_tick()->mutable_items(k)->set_tag(tags[static_cast<std::size_t>(k)]);
    }
    return request;
  };
  const auto said = [&] {  // frame id, and its items' reasons
    std::vector<std::pair<std::uint64_t, std::vector<std::string>>> results;
    for (const auto& message : TakeAll()) {
      if (!message.has_frame_result()) continue;
      std::vector<std::string> reasons;
      for (const auto& item : message.frame_result().items()) {
        EXPECT_EQ(item.has_frame(), item.reason().empty());
        reasons.push_back(item.reason());
      }
      EXPECT_EQ(message.frame_result().superseded(),
                std::count(reasons.begin(), reasons.end(), "SUPERSEDED"));
      results.emplace_back(message.frame_result().frame_id(), reasons);
    }
    return results;
  };
  // A frame of many items waits for a thread, and the others behind it.
  const std::vector<std::uint32_t> crowd(50, 7);
  Say(tagged(1, crowd));
  ASSERT_TRUE(wire_.work);
  Say(tagged(2, {1, 2}));
  Say(tagged(3, {2, 3}));
  const auto results = said();
  ASSERT_EQ(results.size(), 3u);
  EXPECT_EQ(results[0].second, std::vector<std::string>(50, ""));
  EXPECT_THAT(results[1].second, ElementsAre("", "SUPERSEDED"));
  EXPECT_THAT(results[2].second, ElementsAre("", ""));
}

TEST_F(Play, AnswersEveryFrameUnlessOnlyTheLatestIsWanted) {
  BindSlot0();
  Say(Tick(1, std::vector<std::uint32_t>(50, 0)));
  Say(Tick(2, {0}));
  Say(Tick(3, {0}));
  for (const auto& message : TakeAll()) {
    EXPECT_EQ(message.frame_result().superseded(), 0u);
    for (const auto& item : message.frame_result().items()) EXPECT_EQ(item.reason(), "");
  }
}

TEST_F(Play, CutsOffAClientThatOutstaysTheDraining) {
  BindSlot0();
  const auto now = Clock::now();
  stream_.Drain(1s, now);
  TakeAll();
  stream_.Beat(now + 1s);
  EXPECT_TRUE(wire_.finished);
  EXPECT_EQ(wire_.error, ErrorCode::kDraining);
}

// Answers no more than the queue holds, however much was read.
class PlayFarAhead : public Play {
 protected:
  static Limits ManyInFlight() {
    Limits limits;
    limits.max_in_flight = 1'000;
    return limits;
  }
  PlayFarAhead() : Play(SharedSession(), ManyInFlight()) {}
};

TEST_F(PlayFarAhead, StopsAnsweringAReaderThatDoesNotTake) {
  BindSlot0();
  const std::size_t frame_bytes = 256u * 8u * Vertices();
  const int enough = static_cast<int>(PlayStream::kQueuedBytes / frame_bytes) + 10;
  const std::vector<std::uint32_t> slots(256, 0);
  for (int k = 0; k < enough; ++k) Say(Tick(k, slots));
  int answered = 0;
  for (; wire_.work; ++answered) LetWork();
  EXPECT_LE((answered - 1) * frame_bytes, PlayStream::kQueuedBytes);
  EXPECT_LT(answered, enough);
  EXPECT_EQ(TakeAll().size(), static_cast<std::size_t>(enough)) << "what was held back comes later";
}

}  // namespace
}  // namespace posespace
