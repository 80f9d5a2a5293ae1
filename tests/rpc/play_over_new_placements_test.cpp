// SPDX-License-Identifier: Apache-2.0
// Play streams whose session gets new placements: see rpc/placement_fade.h.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "tests/rpc/play_fixture.h"
#include "tests/session/sample_drawings.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;

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
  stream_.Beat(PlayStream::Clock::now());
  EXPECT_EQ(TakeAll().back().revision_changed().revision(), Revision());
  now_ += 1s;
  stream_.Beat(PlayStream::Clock::now());
  const auto first = Ask();
  EXPECT_TRUE(first.fading());
  EXPECT_EQ(first.frame().SerializeAsString(), before.frame().SerializeAsString());
  now_ += kFade;
  EXPECT_FALSE(Ask().fading());
}

TEST_F(PlayOverNewPlacements, IsThereWhenNobodyAskedForLong) {
  BindSlot0();
  Place(1.7);
  stream_.Beat(PlayStream::Clock::now());
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

}  // namespace
}  // namespace posespace
