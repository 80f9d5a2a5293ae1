// SPDX-License-Identifier: Apache-2.0
#include "posespace/player.h"

#include <chrono>
#include <limits>
#include <thread>

#include "tests/client_cpp/live_service.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class PlayerTest : public ::testing::Test {
 protected:
  // Tests only read them.
  const Session& stars() {
    static const Session session = MakeStars(client_);
    return session;
  }
  const Session& seven() {
    static const Session session = [this] {
      Session made = client_.CreateSession();
      made.PutShape("seven", Star(7));
      made.PutShape("turned", Star(7, 0.2));
      made.SetPlacements({{"seven", {0, 0}}, {"turned", {1, 0}}});
      made.Build({.target_edge_length = 0.3});
      return made;
    }();
    return session;
  }

  const Client client_{SharedAddress(), {.timeout = 30s}};
};

Point PlaceOf(int k) { return {0.001 * (k % 1'000), 0.3 + 0.0005 * k}; }

TEST_F(PlayerTest, AnswersATickInTheOrderItWasAsked) {
  Player player = stars().Play();
  for (const int k : {7, 3, 900}) player.Ask(0, static_cast<std::uint32_t>(k), PlaceOf(k));
  const auto answers = player.Tick();
  ASSERT_THAT(answers, SizeIs(3));
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_EQ(answers[k].error, nullptr);
    EXPECT_EQ(answers[k].tag, std::vector<std::uint32_t>({7, 3, 900})[k]);
    const Frame frame = stars().Blend(PlaceOf(static_cast<int>(answers[k].tag)));
    EXPECT_EQ(Distance(answers[k].vertices, frame.vertices), 0.0);
    EXPECT_EQ(answers[k].folds, 0);
    EXPECT_EQ(answers[k].session->revision, frame.revision);
    EXPECT_THAT(answers[k].weights, IsEmpty());
  }
  EXPECT_EQ(player.times_opened(), 1);
}

TEST_F(PlayerTest, SplitsATickThatIsLargerThanAMessage) {
  Player player = stars().Play();
  const int count = 2 * player.max_items() + 17;
  std::vector<Point> points;
  for (int k = 0; k < count; ++k) {
    points.push_back(PlaceOf(k));
    player.Ask(0, static_cast<std::uint32_t>(k), points.back());
  }
  const auto answers = player.Tick();
  const FrameBatch expected = stars().BlendMany(points);
  ASSERT_EQ(answers.size(), points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_EQ(answers[k].tag, k);
    EXPECT_EQ(Distance(answers[k].vertices, expected[k]), 0.0);
  }
}

TEST_F(PlayerTest, KeepsTheOrderOfTicksUnderWay) {
  Player player = stars().Play();
  const int ticks = 3 * player.max_in_flight() + 1;
  for (int tick = 0; tick < ticks; ++tick) {
    player.Ask(0, static_cast<std::uint32_t>(tick), PlaceOf(tick));
    player.Send();
  }
  EXPECT_EQ(player.under_way(), static_cast<std::size_t>(ticks));
  for (int tick = 0; tick < ticks; ++tick) {
    const auto answers = player.Receive();
    ASSERT_THAT(answers, SizeIs(1));
    EXPECT_EQ(answers[0].tag, static_cast<std::uint32_t>(tick));
    EXPECT_EQ(Distance(answers[0].vertices, stars().Blend(PlaceOf(tick)).vertices), 0.0);
  }
  EXPECT_EQ(player.under_way(), 0u);
  EXPECT_THAT([&] { player.Receive(); }, Refuses(ErrorCode::kInvalidArgument, ""));
}

TEST_F(PlayerTest, AnswersATickOfNothingWithNothing) {
  Player player = stars().Play();
  EXPECT_THAT(player.Tick(), IsEmpty());
  player.Ask(0, 1, {0, 0});
  EXPECT_THAT(player.Tick(), SizeIs(1));
  EXPECT_THAT(player.Tick(), IsEmpty());
}

TEST_F(PlayerTest, TicksOfDifferentSizesDoNotMix) {
  Player player = stars().Play();
  for (const int count : {300, 5, 257, 1, 600, 2}) {
    for (int k = 0; k < count; ++k) player.Ask(0, static_cast<std::uint32_t>(k), PlaceOf(k));
    const auto answers = player.Tick();
    ASSERT_EQ(answers.size(), static_cast<std::size_t>(count));
    const auto& last = answers.back();
    EXPECT_EQ(last.tag, static_cast<std::uint32_t>(count - 1));
    EXPECT_EQ(Distance(last.vertices, stars().Blend(PlaceOf(count - 1)).vertices), 0.0);
  }
}

TEST_F(PlayerTest, AnswersWeightsWhenAskedForThem) {
  Player player = stars().Play();
  player.set_with_weights(true);
  player.Ask(0, 0, {0.2, 0.3});
  const auto answers = player.Tick();
  const Frame frame = stars().Blend({0.2, 0.3});
  const std::vector<std::string> shape_ids = answers[0].session->shape_ids;
  ASSERT_THAT(answers[0].weights, SizeIs(shape_ids.size()));
  ASSERT_THAT(answers[0].texture_weights, SizeIs(shape_ids.size()));
  for (std::size_t k = 0; k < shape_ids.size(); ++k) {
    EXPECT_EQ(answers[0].weights[k], frame.weights.at(shape_ids[k]));
    EXPECT_EQ(answers[0].texture_weights[k], frame.texture_weights.at(shape_ids[k]));
  }
}

TEST_F(PlayerTest, ReadsVerticesThatTravelInHalfTheBytes) {
  Player player = stars().Play();
  const auto ask = [&] {
    for (int k = 0; k < 20; ++k) player.Ask(0, static_cast<std::uint32_t>(k), PlaceOf(k));
    return player.Tick();
  };
  player.set_compact(true);
  for (const Answer& answer : ask()) {
    const Frame frame = stars().Blend(PlaceOf(static_cast<int>(answer.tag)));
    const double distance = Distance(answer.vertices, frame.vertices);
    EXPECT_GT(distance, 0.0) << "rounded";
    EXPECT_LE(distance, 300.0 / 128'000.0);
  }
  player.set_compact(false);
  EXPECT_EQ(Distance(ask()[3].vertices, stars().Blend(PlaceOf(3)).vertices), 0.0);
}

TEST_F(PlayerTest, BlendsPointsWeightsAndOptionsInOnePlaceOneAfterAnother) {
  Player player = stars().Play();
  const std::vector<double> weights = {0.25, 0.25, 0.5};
  const BlendOptions linear{.method = BlendMethod::kLinear};
  const Frame at = stars().Blend({0.2, 0.3});
  const Frame at_linear = stars().Blend({0.2, 0.3}, linear);
  const Frame by_weights = stars().Blend({{"up", 0.25}, {"left", 0.25}, {"right", 0.5}});
  for (int round = 0; round < 3; ++round) {
    player.Ask(0, 0, Point{0.2, 0.3});
    EXPECT_EQ(Distance(player.Tick()[0].vertices, at.vertices), 0.0);
    player.Ask(0, 0, weights);
    EXPECT_EQ(Distance(player.Tick()[0].vertices, by_weights.vertices), 0.0);
    player.Ask(0, 0, Point{0.2, 0.3}, linear);
    EXPECT_EQ(Distance(player.Tick()[0].vertices, at_linear.vertices), 0.0);
  }
}

TEST_F(PlayerTest, KeepsAnItemsErrorInItsPlace) {
  Player player = stars().Play();
  player.Ask(0, 10, Point{0, 0});
  player.Ask(0, 11, Point{kNan, 0});
  player.Ask(0, 12, std::vector<double>{0.7, 0.0, 0.0});
  player.Ask(0, 13, std::vector<double>{1.0});
  player.Ask(5, 14, Point{0, 0});
  player.Ask(0, 15, Point{1, 0});
  const auto answers = player.Tick();
  ASSERT_THAT(answers, SizeIs(6));
  const auto reason = [&](std::size_t k) { return answers[k].error->reason(); };
  EXPECT_EQ(answers[0].error, nullptr);
  EXPECT_EQ(reason(1), "POSE_NOT_FINITE");
  EXPECT_EQ(answers[1].error->code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(answers[1].vertices, IsEmpty());
  EXPECT_EQ(reason(2), "WEIGHTS_SUM_NOT_ONE");
  EXPECT_EQ(reason(3), "WEIGHTS_COUNT_MISMATCH");
  EXPECT_EQ(reason(4), "SLOT_NOT_BOUND");
  EXPECT_EQ(answers[4].session, nullptr);
  EXPECT_EQ(answers[5].error, nullptr);
  EXPECT_EQ(answers[5].tag, 15u);
}

TEST_F(PlayerTest, BindsSeveralSessionsAndFreesTheirSlots) {
  Player player = stars().Play();
  const std::uint32_t slot = player.Bind(seven());
  EXPECT_EQ(slot, 1u);
  EXPECT_THAT(player.Bound(slot).shape_ids, ElementsAre("seven", "turned"));
  EXPECT_EQ(player.Bound(0).session_id, stars().id());
  player.Ask(0, 0, {0.3, 0.3});
  player.Ask(slot, 1, {0.5, 0.0});
  const auto answers = player.Tick();
  EXPECT_EQ(Distance(answers[0].vertices, stars().Blend({0.3, 0.3}).vertices), 0.0);
  EXPECT_EQ(Distance(answers[1].vertices, seven().Blend({0.5, 0.0}).vertices), 0.0);
  EXPECT_EQ(answers[1].vertices.size(),
            2 * static_cast<std::size_t>(player.Bound(slot).vertex_count));
  player.Unbind(slot);
  EXPECT_THAT([&] { player.Bound(slot); }, Refuses(ErrorCode::kNotBuilt, "SLOT_NOT_BOUND"));
  player.Ask(slot, 1, {0.5, 0.0});
  EXPECT_EQ(player.Tick()[0].error->reason(), "SLOT_NOT_BOUND");
  EXPECT_EQ(player.Bind(stars()), slot);
}

TEST_F(PlayerTest, BindsBetweenTicksUnderWay) {
  Player player = stars().Play();
  player.Ask(0, 0, {0.3, 0.3});
  player.Send();
  const std::uint32_t slot = player.Bind(seven());
  player.Ask(slot, 1, {0.5, 0.0});
  player.Send();
  EXPECT_EQ(player.Receive()[0].tag, 0u);
  EXPECT_EQ(Distance(player.Receive()[0].vertices, seven().Blend({0.5, 0.0}).vertices), 0.0);
}

TEST_F(PlayerTest, RefusesSessionsThatCannotBeBoundAndGoesOn) {
  Player player = stars().Play();
  Session empty = client_.CreateSession();
  empty.PutShape("a", Star());
  EXPECT_THAT([&] { player.Bind(empty); }, Refuses(ErrorCode::kNotBuilt, "SESSION_NOT_BUILT"));
  EXPECT_THAT([&] { player.Bind(stars(), "another"); },
              Refuses(ErrorCode::kNotFound, "REVISION_NOT_FOUND"));
  while (player.Bind(stars()) + 1 < static_cast<std::uint32_t>(player.max_slots())) {
  }
  EXPECT_THAT([&] { player.Bind(stars()); }, Refuses(ErrorCode::kInvalidArgument, "SLOT_LIMIT"));
  player.Ask(0, 0, {0, 0});
  EXPECT_EQ(player.Tick()[0].error, nullptr);
}

TEST_F(PlayerTest, FollowsARebuildAndSaysSo) {
  Session session = MakeStars(client_);
  Player player = session.Play();
  player.Ask(0, 0, {0.5, 0.0});
  const std::string before = player.Tick()[0].session->revision;
  const auto after =
      session.SetPlacements({{"up", {0, 0}}, {"left", {0.5, 0}}, {"right", {0, 1}}}).revision;
  player.Ask(0, 0, {0.5, 0.0});
  const auto answers = player.Tick();
  EXPECT_NE(answers[0].session->revision, before);
  EXPECT_EQ(answers[0].session->revision, after);
  EXPECT_EQ(player.Bound(0).revision, after);
}

TEST_F(PlayerTest, ComesOverToNewPlacementsAndSaysHowLong) {
  Session session = MakeStars(client_);
  Player player = session.Play();
  const Frame before = session.Blend({0.5, 0.0});
  session.SetPlacements({{"up", {0, 0}}, {"left", {0.5, 0}}, {"right", {0, 1}}});
  const Frame after = session.Blend({0.5, 0.0});
  player.Ask(0, 0, {0.5, 0.0});
  auto answers = player.Tick();
  EXPECT_TRUE(answers[0].fading);
  EXPECT_EQ(Distance(answers[0].vertices, before.vertices), 0.0);
  while (answers[0].fading) {
    player.Ask(0, 0, {0.5, 0.0});
    answers = player.Tick();
  }
  EXPECT_EQ(Distance(answers[0].vertices, after.vertices), 0.0);
  EXPECT_GT(Distance(before.vertices, after.vertices), 1.0);
}

TEST_F(PlayerTest, StaysWithAPinnedRevision) {
  Session session = MakeStars(client_);
  const std::string revision = session.State().revision;
  Player player = session.Play(revision);
  const Frame before = session.Blend({0.5, 0.0});
  session.SetPlacements({{"up", {0, 0}}, {"left", {0.5, 0}}, {"right", {0, 1}}});
  player.Ask(0, 0, {0.5, 0.0});
  const auto answers = player.Tick();
  EXPECT_EQ(answers[0].session->revision, revision);
  EXPECT_EQ(Distance(answers[0].vertices, before.vertices), 0.0);
}

TEST_F(PlayerTest, AnswersWeightsForOtherDrawingsWithAConflict) {
  Session session = MakeStars(client_);
  Player player = session.Play();
  player.Ask(0, 0, std::vector<double>{1.0, 0.0, 0.0});  // meant for up, left, right
  session.DeleteShape("up");
  session.PutShape("other", Star(5, 0.1));
  session.SetPlacements({{"left", {1, 0}}, {"right", {0, 1}}, {"other", {0, 0}}});
  session.Build({.target_edge_length = 0.3});
  const auto answers = player.Tick();
  ASSERT_NE(answers[0].error, nullptr);
  EXPECT_EQ(answers[0].error->code(), ErrorCode::kConflict);
  player.Ask(0, 0, std::vector<double>{1.0, 0.0, 0.0});
  EXPECT_EQ(player.Tick()[0].error, nullptr);
}

TEST_F(PlayerTest, SaysThatASessionWasDeletedAndAnswersTheOthers) {
  Session doomed = MakeStars(client_);
  Player player = stars().Play();
  const std::uint32_t slot = player.Bind(doomed);
  doomed.Delete();
  player.Ask(slot, 0, {0, 0});
  player.Ask(0, 1, {0, 0});
  const auto answers = player.Tick();
  ASSERT_NE(answers[0].error, nullptr);
  EXPECT_EQ(answers[0].error->code(), ErrorCode::kNotFound);
  EXPECT_EQ(answers[0].error->reason(), "SESSION_NOT_FOUND");
  EXPECT_EQ(answers[1].error, nullptr);
  EXPECT_EQ(player.Bound(slot).revision, "");
}

TEST_F(PlayerTest, AnswersStayGoodUntilTheNextOnes) {
  Player player = stars().Play();
  const Frame expected = stars().Blend({0.2, 0.2});
  player.Ask(0, 0, {0.2, 0.2});
  const auto answers = player.Tick();
  for (int k = 0; k < 300; ++k) player.Ask(0, 0, {0.9, 0.9});
  player.Send();
  std::this_thread::sleep_for(400ms);  // the keeper reads the next answers meanwhile
  EXPECT_EQ(Distance(answers[0].vertices, expected.vertices), 0.0);
  EXPECT_THAT(player.Receive(), SizeIs(300));
}

TEST_F(PlayerTest, PlayersOfOneClientDoNotDisturbEachOther) {
  std::vector<std::jthread> threads;
  std::atomic<int> wrong = 0;
  const Frame expected = stars().Blend({0.4, 0.1});
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&] {
      Player player = stars().Play();
      for (int tick = 0; tick < 50; ++tick) {
        player.Ask(0, 0, {0.4, 0.1});
        if (Distance(player.Tick()[0].vertices, expected.vertices) != 0.0) ++wrong;
      }
    });
  }
  threads.clear();
  EXPECT_EQ(wrong, 0);
}

TEST_F(PlayerTest, CanBeMoved) {
  Player first = stars().Play();
  first.Ask(0, 1, {0, 0});
  Player second = std::move(first);
  second.Ask(0, 2, {0, 0});
  EXPECT_THAT(second.Tick(), SizeIs(2));
}

TEST_F(PlayerTest, AnimatesAlongAPathAsBlendDoes) {
  const std::vector<Point> path = {{0, 0}, {1, 0}, {0, 1}};
  Animation animation = stars().Animate(path, {.fps = 10.0});
  int count = 0;
  while (const auto frame = animation.Next()) {
    EXPECT_EQ(frame->index, count++);
    EXPECT_NEAR(frame->time, frame->index / 10.0, 1e-9);
    const Frame expected = stars().Blend(frame->at);
    EXPECT_EQ(Distance(frame->frame.vertices, expected.vertices), 0.0);
    EXPECT_EQ(frame->frame.weights, expected.weights);
  }
  EXPECT_GT(count, 10);
  EXPECT_FALSE(animation.Next());
  EXPECT_THAT([&] { stars().Animate(std::vector<Point>{}).Next(); },
              Refuses(ErrorCode::kInvalidArgument, "PATH_INVALID"));
}

TEST_F(PlayerTest, AnAnimationCanBeLeftEarly) {
  const std::vector<Waypoint> path = {{{0, 0}, 0.0}, {{1, 1}, 1'000.0}};
  Animation animation = stars().Animate(path, {.fps = 60.0, .easing = Easing::kInOut});
  ASSERT_TRUE(animation.Next());
  ASSERT_TRUE(animation.Next());
}

}  // namespace
}  // namespace posespace
