// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_stream.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/interpolation/counted_allocations.h"
#include "tests/rpc/built_session.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/flaky_store.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using Clock = PlayStream::Clock;

// Everything a stream asks for, kept until the test lets it happen.
class Wire final : public PlayTransport {
 public:
  void StartRead(v1::PlayRequest* message) override {
    EXPECT_EQ(reading, nullptr) << "two reads at once";
    reading = message;
    if (during_read) std::thread(std::ref(during_read)).join();
    EXPECT_FALSE(finished);
  }
  void StartWrite(MessageBytes message) override {
    EXPECT_EQ(writing, nullptr) << "two writes at once";
    EXPECT_FALSE(finished);
    if (parse) {
      EXPECT_TRUE(written.ParseFromArray(message.data(), static_cast<int>(message.size())));
    }
    bytes = std::move(message);
    writing = &written;
    if (during_write) std::thread(std::ref(during_write)).join();
  }
  void ScheduleWork() override {
    EXPECT_FALSE(work) << "two threads at once";
    work = true;
  }
  void ScheduleLoad() override {
    ++loads;
    ScheduleWork();
  }
  void Finish(Result<void> outcome) override {
    EXPECT_FALSE(finished) << "finished twice";
    finished = true;
    error = outcome ? std::nullopt : std::optional(outcome.error().code);
  }

  // What another thread does while a read or a write is being started.
  std::function<void()> during_read, during_write;

  v1::PlayRequest* reading = nullptr;
  MessageBytes bytes;
  bool parse = true;
  v1::PlayResponse written;  // the same, parsed
  const v1::PlayResponse* writing = nullptr;
  bool work = false;
  int loads = 0;
  bool finished = false;
  std::optional<ErrorCode> error;
};

// One session for all tests that leave it as it is: builds take their time.
BuiltSession& SharedSession() {
  static BuiltSession session;
  return session;
}

class Play : public ::testing::Test {
 protected:
  explicit Play(BuiltSession& sessions = SharedSession(), const Limits& limits = {})
      : sessions_(sessions),
        stream_(sessions_.registry(), limits, wire_, Clock::time_point::max(),
                [this] { return now_; }) {
    stream_.Start();
  }

  // The client says something.
  void Say(const v1::PlayRequest& message) {
    ASSERT_NE(wire_.reading, nullptr) << "the stream does not listen";
    *std::exchange(wire_.reading, nullptr) = message;
    stream_.OnRead(true);
  }
  void SayAll() {
    wire_.reading = nullptr;
    stream_.OnRead(false);
  }
  void LetWork() {
    ASSERT_TRUE(std::exchange(wire_.work, false)) << "there is no work";
    stream_.Work();
  }
  // The client takes one message.
  v1::PlayResponse Take() {
    if (wire_.writing == nullptr) {
      ADD_FAILURE() << "nothing is written";
      return {};
    }
    const v1::PlayResponse message = *std::exchange(wire_.writing, nullptr);
    stream_.OnWritten(true);
    return message;
  }
  // All that comes of itself: work is done, messages are taken.
  std::vector<v1::PlayResponse> TakeAll() {
    std::vector<v1::PlayResponse> messages;
    while (wire_.work || wire_.writing != nullptr) {
      if (wire_.work) {
        LetWork();
      } else {
        messages.push_back(Take());
      }
    }
    return messages;
  }

  static v1::PlayRequest Bind(std::uint32_t slot, const std::string& session = "cell",
                              const std::string& revision = "") {
    v1::PlayRequest request;
    request.mutable_bind()->set_slot(slot);
    request.mutable_bind()->set_session_id(session);
    request.mutable_bind()->set_pinned_revision(revision);
    return request;
  }
  static v1::PlayRequest Unbind(std::uint32_t slot) {
    v1::PlayRequest request;
    request.mutable_unbind()->set_slot(slot);
    return request;
  }
  static v1::PlayRequest Tick(std::uint64_t frame_id, const std::vector<std::uint32_t>& slots,
                              double y = 0.5) {
    v1::PlayRequest request;
    request.mutable_tick()->set_frame_id(frame_id);
    for (const std::uint32_t slot : slots) {
      auto* const item = request.mutable_tick()->add_items();
      item->set_slot(slot);
      item->set_tag(static_cast<std::uint32_t>(100 + request.tick().items_size()));
      item->mutable_query()->mutable_at()->set_y(y);
    }
    return request;
  }
  // Binds slot 0 and forgets what was said so far.
  void BindSlot0() {
    Say(Bind(0));
    ASSERT_EQ(TakeAll().back().bound().reason(), "");
  }
  std::string Revision() { return (*sessions_.session().Built())->revision(); }
  int Vertices() { return (*sessions_.session().Built())->mesh().num_vertices(); }

  // Plays messages of one, some and many items until memory is what they need, and counts then.
  void ExpectNoAllocationForAnItem() {
    wire_.parse = false;
    for (const std::size_t count : {1, 16, 64}) {
      const v1::PlayRequest tick = Tick(1, std::vector<std::uint32_t>(count, 0), 0.3);
      const std::string bytes = tick.SerializeAsString();
      const auto play = [&] {
        ASSERT_NE(wire_.reading, nullptr);
        ASSERT_TRUE(std::exchange(wire_.reading, nullptr)->ParseFromString(bytes));
        stream_.OnRead(true);
        if (std::exchange(wire_.work, false)) stream_.Work();
        ASSERT_GT(wire_.bytes.size(), count * 8 * Vertices());
        wire_.bytes = {};
        wire_.writing = nullptr;
        stream_.OnWritten(true);
      };
      for (int k = 0; k < 10; ++k) play();
      const int before = CountedAllocations();
      constexpr int kMessages = 100;
      for (int k = 0; k < kMessages; ++k) play();
      // What protobuf reads a message into, however many items it has.
      EXPECT_LE(CountedAllocations() - before, 4 * kMessages) << count << " items";
    }
    wire_.parse = true;
  }

  BuiltSession& sessions_;
  Clock::time_point now_ = Clock::now();
  Wire wire_;
  PlayStream stream_;
};

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

// A session of its own; made before the stream.
struct OwnSession {
  BuiltSession own;
};
class PlayOfAChangingSession : private OwnSession, public Play {
 protected:
  PlayOfAChangingSession() : Play(own) {}
};

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

// A session whose drawings are placed anew under its stream.
class PlayOverNewPlacements : public PlayOfAChangingSession {
 protected:
  static constexpr auto kFade = Limits{}.placement_fade;

  void Place(double tall_y) {
    ASSERT_TRUE(
        sessions_.session().SetPlacements({{"wide", Point(0, 0)}, {"tall", Point(0, tall_y)}}, ""));
  }
  // The answer to one item at a point, after other messages if there are any.
  v1::PlayResponse::ItemResult Ask(double y = 0.5) {
    auto tick = Tick(++frames_, {0}, y);
    tick.mutable_tick()->set_with_weights(true);
    Say(tick);
    messages_ = TakeAll();
    return messages_.back().frame_result().items(0);
  }
  // What it would be at rest.
  Frame Exact(double y = 0.5) {
    return (*sessions_.session().Built())->Blend({Point(0, y), {}, 0.0}).value();
  }
  static std::vector<float> VerticesOf(const v1::PlayResponse::ItemResult& item) {
    std::vector<float> vertices(item.frame().vertices().size() / sizeof(float));
    std::memcpy(vertices.data(), item.frame().vertices().data(), item.frame().vertices().size());
    return vertices;
  }
  static std::vector<float> VerticesOf(const Frame& frame) {
    return {frame.vertices.data(), frame.vertices.data() + frame.vertices.size()};
  }
  static double Distance(const std::vector<float>& a, const std::vector<float>& b) {
    double distance = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
      distance = std::fmax(distance, std::abs(a[k] - b[k]));
    return distance;
  }

  std::uint64_t frames_ = 0;
  std::vector<v1::PlayResponse> messages_;
};

TEST_F(PlayOverNewPlacements, BeginsWithTheOldFrameAndEndsExactlyWithTheNewOne) {
  BindSlot0();
  const auto before = Ask();
  EXPECT_FALSE(before.fading());
  Place(1.7);
  const auto first = Ask();
  ASSERT_EQ(messages_.size(), 2u);
  EXPECT_EQ(messages_[0].revision_changed().revision(), Revision());
  EXPECT_TRUE(first.fading());
  EXPECT_EQ(first.frame().SerializeAsString(), before.frame().SerializeAsString());

  const double way = Distance(VerticesOf(before), VerticesOf(Exact()));
  ASSERT_GT(way, 5.0) << "pixels";
  std::vector<float> last = VerticesOf(first);
  for (auto passed = 5ms; passed < kFade; passed += 5ms) {
    now_ += 5ms;
    const auto item = Ask();
    EXPECT_TRUE(item.fading());
    EXPECT_NEAR(item.frame().weights(0) + item.frame().weights(1), 1.0, 1e-9);
    EXPECT_NEAR(item.frame().texture_weights(0) + item.frame().texture_weights(1), 1.0, 1e-9);
    const auto vertices = VerticesOf(item);
    EXPECT_LT(Distance(vertices, last), 0.1 * way);
    last = vertices;
  }
  now_ += 5ms;
  const auto arrived = Ask();
  EXPECT_FALSE(arrived.fading());
  const Frame exact = Exact();
  EXPECT_EQ(VerticesOf(arrived), VerticesOf(exact));
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(arrived.frame().weights(i), exact.weights[i]);
    EXPECT_EQ(arrived.frame().texture_weights(i), exact.texture_weights[i]);
  }
}

TEST_F(PlayOverNewPlacements, BeginsWithTheOldFrameForAnAvatarThatRests) {
  BindSlot0();
  const auto before = Ask();
  Place(1.7);
  stream_.Beat(Clock::now());
  EXPECT_EQ(TakeAll().back().revision_changed().revision(), Revision());
  now_ += 1s;
  stream_.Beat(Clock::now());
  const auto first = Ask();
  EXPECT_TRUE(first.fading());
  EXPECT_EQ(first.frame().SerializeAsString(), before.frame().SerializeAsString());
  now_ += kFade;
  EXPECT_FALSE(Ask().fading());
}

TEST_F(PlayOverNewPlacements, IsThereWhenNobodyAskedForLong) {
  BindSlot0();
  Place(1.7);
  stream_.Beat(Clock::now());
  TakeAll();
  now_ += PlacementFade::kPatience;
  const auto item = Ask();
  EXPECT_FALSE(item.fading());
  EXPECT_EQ(VerticesOf(item), VerticesOf(Exact()));
}

TEST_F(PlayOverNewPlacements, GoesOnFromWhereItIsWhenTheyChangeAgain) {
  BindSlot0();
  Place(1.7);
  Ask();
  now_ += 60ms;
  const auto seen = VerticesOf(Ask());
  Place(0.6);
  now_ += 1ms;
  const auto again = Ask();
  EXPECT_EQ(messages_[0].revision_changed().revision(), Revision());
  EXPECT_TRUE(again.fading());
  EXPECT_LT(Distance(VerticesOf(again), seen), 1e-3);
  EXPECT_GT(Distance(seen, VerticesOf(Exact())), 1.0);
  now_ += kFade;
  EXPECT_EQ(VerticesOf(Ask()), VerticesOf(Exact()));
}

TEST_F(PlayOverNewPlacements, WaitsWithChangesThatComeTooFastToMixAndArrivesAtTheLast) {
  BindSlot0();
  std::vector<float> last = VerticesOf(Ask());
  constexpr int kChanges = 2 * PlacementFade::kMostLeft;
  int said = 0;
  for (int k = 0; k < kChanges; ++k) {
    Place(k % 2 == 0 ? 1.7 : 0.6);
    for (int step = 0; step < 2; ++step) {
      now_ += 5ms;
      const auto vertices = VerticesOf(Ask());
      said += static_cast<int>(messages_.size()) - 1;
      EXPECT_LT(Distance(vertices, last), 3.0) << k;
      last = vertices;
    }
  }
  EXPECT_EQ(said, PlacementFade::kMostLeft);
  for (int k = 0; k < 100; ++k) {
    now_ += 5ms;
    const auto vertices = VerticesOf(Ask());
    EXPECT_LT(Distance(vertices, last), 3.0);
    last = vertices;
  }
  EXPECT_EQ(last, VerticesOf(Exact()));
}

TEST_F(PlayOverNewPlacements, LeavesItemsByWeightsAsTheyAre) {
  BindSlot0();
  Place(1.7);
  auto tick = Tick(1, {0, 0});
  v1::Weights& weights = *tick.mutable_tick()->mutable_items(1)->mutable_query()->mutable_weights();
  weights.add_values(0.3);
  weights.add_values(0.7);
  Say(tick);
  const auto result = TakeAll().back().frame_result();
  EXPECT_TRUE(result.items(0).fading());
  EXPECT_FALSE(result.items(1).fading());
  const Eigen::VectorXd asked = Eigen::Vector2d(0.3, 0.7);
  EXPECT_EQ(VerticesOf(result.items(1)),
            VerticesOf((*sessions_.session().Built())->Blend({asked, {}, 0.0}).value()));
}

TEST_F(PlayOverNewPlacements, IsAtOnceWhenDrawingsAreBuiltAnewAlsoMeanwhile) {
  BindSlot0();
  Place(1.7);
  Ask();
  now_ += 60ms;
  EXPECT_TRUE(Ask().fading());
  sessions_.Put("tall", EllipseOf(30, 90));
  sessions_.Build();
  const auto item = Ask();
  EXPECT_EQ(messages_[0].revision_changed().revision(), Revision());
  EXPECT_FALSE(item.fading());
  EXPECT_EQ(VerticesOf(item), VerticesOf(Exact()));
}

TEST_F(PlayOverNewPlacements, IsOfTheSlotAlone) {
  BindSlot0();
  Say(Bind(1, "cell", Revision()));
  TakeAll();
  Place(1.7);
  Say(Tick(1, {0, 1, 0}));
  const auto result = TakeAll().back().frame_result();
  EXPECT_TRUE(result.items(0).fading());
  EXPECT_FALSE(result.items(1).fading()) << "pinned";
  EXPECT_TRUE(result.items(2).fading());
  EXPECT_EQ(result.items(0).frame().vertices(), result.items(1).frame().vertices());
  Say(Bind(0));
  Say(Tick(2, {0}));
  EXPECT_FALSE(TakeAll().back().frame_result().items(0).fading()) << "bound anew";
}

TEST_F(PlayOverNewPlacements, AllocatesNothingForAnItemMeanwhile) {
  BindSlot0();
  Place(1.7);
  EXPECT_TRUE(Ask().fading());
  now_ += 60ms;  // and stays there
  ExpectNoAllocationForAnItem();
  EXPECT_TRUE(Ask().fading());
}

// Four drawings in a row, each turned on by 1.9 against the one before, have other turns in another
// order: the same weights are not the same drawing then.
TEST_F(PlayOverNewPlacements, IsAtOnceWhenDrawingsTurnAnotherWay) {
  const auto session = *sessions_.registry().Create({"wheel", "", {}, "wheel"});
  std::vector<Correspondence> marks(3);
  const auto place = [&](const std::vector<double>& xs) {
    Placements placements;
    for (std::size_t i = 0; i < xs.size(); ++i) {
      placements["turn" + std::to_string(i)] = Point(xs[i], 0);
    }
    ASSERT_TRUE(session->SetPlacements(placements, ""));
  };
  for (int i = 0; i < 4; ++i) {
    const std::string id = "turn" + std::to_string(i);
    const Points ring = TurnedCreatureRing(1.9 * i);
    ASSERT_TRUE(session->PutShape(id, PolygonSource{ring, {}, {}}, /*replace=*/false));
    for (int k = 0; k < 3; ++k) marks[k][id] = ring.row(20 * k);
  }
  ASSERT_TRUE(session->SetCorrespondences(marks, ""));
  place({0, 1, 2, 3});
  ASSERT_TRUE(session->StartBuild({.target_edge_length = 0.25}, sessions_.registry().build_pool()));
  while (!session->LatestBuild()->Status().ended()) std::this_thread::sleep_for(1ms);
  const auto before = *session->Built();
  Say(Bind(0, "wheel"));
  ASSERT_EQ(TakeAll().back().bound().reason(), "");

  place({0, 1.1, 2, 3});
  ASSERT_EQ((*session->Built())->turns(), before->turns());
  EXPECT_TRUE(Ask(0.0).fading());
  place({0, 3, 1, 2});
  ASSERT_NE((*session->Built())->turns(), before->turns());
  EXPECT_FALSE(Ask(0.0).fading());
}

class PlayWithoutFades : private OwnSession, public Play {
 protected:
  static Limits AtOnce() {
    Limits limits;
    limits.placement_fade = 0ms;
    return limits;
  }
  PlayWithoutFades() : Play(own, AtOnce()) {}
};

TEST_F(PlayWithoutFades, IsAtNewPlacementsAtOnce) {
  BindSlot0();
  ASSERT_TRUE(
      sessions_.session().SetPlacements({{"wide", Point(0, 0)}, {"tall", Point(0, 2)}}, ""));
  auto tick = Tick(1, {0}, 2.0);
  tick.mutable_tick()->set_with_weights(true);
  Say(tick);
  const auto item = TakeAll().back().frame_result().items(0);
  EXPECT_FALSE(item.fading());
  EXPECT_NEAR(item.frame().weights(1), 1.0, 1e-9);
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
