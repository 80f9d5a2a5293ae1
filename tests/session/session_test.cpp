// SPDX-License-Identifier: Apache-2.0
#include "session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A session of creatures "a", "b", ...
class SessionTest : public testing::Test {
 protected:
  void Put(const std::string& ids) {
    for (const char id : ids) {
      ASSERT_THAT(session_.PutShape(std::string(1, id), CreaturePolygon(0.1 * (id - 'a')), false),
                  Succeeds());
    }
  }
  // A mark on the outline of creature `id`.
  static Point Mark(char id, int row) { return CreatureRing(0.1 * (id - 'a')).row(row); }

  Session session_{"tux", "Tux", {{"owner", "me"}}, Limits()};
};

TEST_F(SessionTest, ShowsWhatItIs) {
  Put("ba");
  const SessionView view = session_.View();
  EXPECT_EQ(view.id, "tux");
  EXPECT_EQ(view.display_name, "Tux");
  EXPECT_EQ(view.labels.at("owner"), "me");
  EXPECT_THAT(view.shape_ids, testing::ElementsAre("b", "a"));
  EXPECT_TRUE(view.placements_are_default);
  EXPECT_TRUE(view.placements.at("b").isApprox(Point(1, 0)));
  EXPECT_TRUE(view.placements.at("a").isApprox(Point(-1, 0)));
  EXPECT_TRUE(view.revision.empty());
  EXPECT_FALSE(view.build.has_value());
  EXPECT_LE(view.created, view.updated);
}

TEST_F(SessionTest, AnswersTheSameDrawingAgainAsTheFirstTime) {
  Put("a");
  const std::string etag = session_.etag();
  const auto first = session_.FindShape("a");
  const auto again = session_.PutShape("a", CreaturePolygon(0.0), false);
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ(*again, *first);
  EXPECT_EQ(*session_.PutShape("a", CreaturePolygon(0.0), true), *first);
  EXPECT_EQ(session_.etag(), etag);
}

TEST_F(SessionTest, ReplacesADrawingOnlyWhenAsked) {
  Put("ab");
  EXPECT_THAT(session_.PutShape("a", CreaturePolygon(0.4), false),
              FailsWith(ErrorCode::kShapeExists, "shape_id"));
  const auto replaced = session_.PutShape("a", CreaturePolygon(0.4), true);
  ASSERT_THAT(replaced, Succeeds());
  EXPECT_EQ(*session_.FindShape("a"), *replaced);
  EXPECT_THAT(session_.View().shape_ids, testing::ElementsAre("a", "b"));
}

TEST_F(SessionTest, KeepsItsDrawingWhenAReplacementIsRefused) {
  Put("a");
  const auto before = session_.FindShape("a");
  EXPECT_THAT(session_.PutShape("a", ImageSource{{1, 2, 3}}, true),
              FailsWith(ErrorCode::kImageUndecodable));
  EXPECT_EQ(*session_.FindShape("a"), *before);
}

TEST_F(SessionTest, RefusesIdsThatAreNone) {
  EXPECT_THAT(session_.PutShape("", CreaturePolygon(0), false),
              FailsWith(ErrorCode::kInvalidId, "shape_id"));
  EXPECT_THAT(session_.PutShape("a']", CreaturePolygon(0), false),
              FailsWith(ErrorCode::kInvalidId));
  EXPECT_THAT(session_.FindShape("a"), FailsWith(ErrorCode::kShapeNotFound));
}

TEST(Session, HoldsAsManyDrawingsAndPixelsAsItsLimits) {
  Limits limits;
  limits.max_shapes = 2;
  limits.max_session_pixels = 128 * 128 + 64 * 64;
  Session session("tux", "", {}, limits);
  EXPECT_THAT(session.PutShape("a", CreaturePicture(0.0, 128), false), Succeeds());
  EXPECT_THAT(session.PutShape("b", CreaturePicture(0.0, 65), false),
              FailsWith(ErrorCode::kImageTooLarge, "image.data"));
  EXPECT_THAT(session.PutShape("b", CreaturePicture(0.0, 64), false), Succeeds());
  EXPECT_THAT(session.PutShape("c", CreaturePicture(0.0, 32), false),
              FailsWith(ErrorCode::kTooManyShapes));
  EXPECT_THAT(session.PutShape("a", CreaturePicture(0.1, 128), true), Succeeds());
}

TEST_F(SessionTest, ForgetsADrawingWithItsMarksAndItsPlace) {
  Put("ab");
  ASSERT_THAT(session_.SetCorrespondences(
                  {{{"a", Mark('a', 5)}, {"b", Mark('b', 5)}}, {{"a", Mark('a', 20)}}}, ""),
              Succeeds());
  ASSERT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(1, 0)}}, ""), Succeeds());
  ASSERT_THAT(session_.DeleteShape("a"), Succeeds());
  const SessionView view = session_.View();
  EXPECT_THAT(view.shape_ids, testing::ElementsAre("b"));
  ASSERT_EQ(view.correspondences.size(), 1u);
  EXPECT_EQ(view.correspondences[0].size(), 1u);
  EXPECT_TRUE(view.correspondences[0].contains("b"));
  EXPECT_EQ(view.placements.size(), 1u);
  EXPECT_THAT(session_.DeleteShape("a"), FailsWith(ErrorCode::kShapeNotFound));
  ASSERT_THAT(session_.DeleteShape("b"), Succeeds());
  EXPECT_TRUE(session_.View().placements_are_default);
  EXPECT_TRUE(session_.View().correspondences.empty());
}

TEST_F(SessionTest, ChangesItsEtagWithEveryEdit) {
  std::vector<std::string> etags = {session_.etag()};
  const auto expect_new = [&] {
    EXPECT_THAT(etags, testing::Not(testing::Contains(session_.etag())));
    etags.push_back(session_.etag());
  };
  Put("a");
  expect_new();
  ASSERT_THAT(session_.PutShape("a", CreaturePolygon(0.3), true), Succeeds());
  expect_new();
  ASSERT_THAT(session_.SetCorrespondences({}, ""), Succeeds());
  expect_new();
  ASSERT_THAT(session_.SetPlacements({}, ""), Succeeds());
  expect_new();
  ASSERT_THAT(session_.DeleteShape("a"), Succeeds());
  expect_new();
  EXPECT_NE(Session("tux", "", {}, Limits()).etag(), Session("tux", "", {}, Limits()).etag());
}

TEST_F(SessionTest, EditsOnlyWhatTheCallerHasSeen) {
  Put("a");
  const std::string seen = session_.etag();
  Put("b");
  const Placements places = {{"a", Point(0, 0)}, {"b", Point(1, 0)}};
  EXPECT_THAT(session_.SetPlacements(places, seen), FailsWith(ErrorCode::kEtagMismatch, "etag"));
  EXPECT_THAT(session_.SetCorrespondences({}, seen), FailsWith(ErrorCode::kEtagMismatch));
  EXPECT_TRUE(session_.View().placements_are_default);
  EXPECT_THAT(session_.SetPlacements(places, session_.etag()), Succeeds());
  EXPECT_THAT(session_.SetCorrespondences({}, session_.etag()), Succeeds());
}

TEST_F(SessionTest, ChecksMarksAtOnce) {
  Put("ab");
  const Correspondence good = {{"a", Mark('a', 5)}, {"b", Mark('b', 5)}};
  EXPECT_THAT(session_.SetCorrespondences({good}, ""), Succeeds());
  EXPECT_THAT(session_.SetCorrespondences({good, {{"a", Point(kNan, 0)}}}, ""),
              FailsWith(ErrorCode::kLandmarkNotFinite, "tuples[1].points['a']"));
  EXPECT_THAT(session_.SetCorrespondences({good, {{"b", Point(1e6, 0)}}}, ""),
              FailsWith(ErrorCode::kLandmarkOffOutline, "tuples[1].points['b']"));
  EXPECT_THAT(session_.SetCorrespondences({{{"x", Point(0, 0)}}, good, {{"y", Point(0, 0)}}}, ""),
              FailsWith(ErrorCode::kShapeNotFound, "tuples[2].points['y']"));
  EXPECT_THAT(session_.SetCorrespondences({good, {}}, ""),
              FailsWith(ErrorCode::kInvalidOption, "tuples[1]"));
  EXPECT_EQ(session_.View().correspondences.size(), 1u) << "a refusal changes nothing";
}

TEST_F(SessionTest, RefusesMarksWhoseOrderContradicts) {
  Put("ab");
  const std::vector<Correspondence> crossed = {{{"a", Mark('a', 5)}, {"b", Mark('b', 5)}},
                                               {{"a", Mark('a', 20)}, {"b", Mark('b', 40)}},
                                               {{"a", Mark('a', 40)}, {"b", Mark('b', 20)}}};
  EXPECT_THAT(session_.SetCorrespondences(crossed, ""), FailsWith(ErrorCode::kLandmarksOutOfOrder));
}

TEST_F(SessionTest, TakesAsManyMarksAsItsLimit) {
  Put("a");
  std::vector<Correspondence> tuples(257, {{"a", Mark('a', 5)}});
  EXPECT_THAT(session_.SetCorrespondences(tuples, ""), FailsWith(ErrorCode::kTooManyLandmarks));
  for (std::size_t k = 0; k < tuples.size(); ++k) {
    tuples[k]["a"] = CreatureRing(0.0, 257).row(static_cast<Eigen::Index>(k));
  }
  tuples.pop_back();
  EXPECT_THAT(session_.SetCorrespondences(tuples, ""), Succeeds());
}

TEST_F(SessionTest, TakesPlacementsOfAllDrawingsOrNone) {
  Put("ab");
  EXPECT_THAT(session_.SetPlacements({{"a", Point(0, 0)}}, ""),
              FailsWith(ErrorCode::kInvalidOption, "placements['b']"));
  EXPECT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"c", Point(1, 0)}}, ""),
              FailsWith(ErrorCode::kShapeNotFound, "placements['c']"));
  EXPECT_THAT(session_.SetPlacements({{"a", Point(0, 0)}, {"b", Point(0, kNan)}}, ""),
              FailsWith(ErrorCode::kPlacementNotFinite, "placements['b'].at"));
  EXPECT_THAT(session_.SetPlacements({{"a", Point(4, 4)}, {"b", Point(4, 4)}}, ""),
              FailsWith(ErrorCode::kPlacementsCoincide, "placements['b'].at"));
  EXPECT_TRUE(session_.View().placements_are_default);

  ASSERT_THAT(session_.SetPlacements({{"a", Point(3, 4)}, {"b", Point(5, 6)}}, ""), Succeeds());
  EXPECT_FALSE(session_.View().placements_are_default);
  EXPECT_EQ(session_.View().placements.at("b"), Point(5, 6));
  ASSERT_THAT(session_.SetPlacements({}, ""), Succeeds());
  EXPECT_TRUE(session_.View().placements_are_default);
}

TEST_F(SessionTest, TakesNoMoreEditsOnceClosed) {
  Put("a");
  EXPECT_THAT(session_.Delete("another etag"), FailsWith(ErrorCode::kEtagMismatch));
  EXPECT_FALSE(session_.closed());
  EXPECT_THAT(session_.Delete(session_.etag()), Succeeds());
  EXPECT_TRUE(session_.closed());
  EXPECT_THAT(session_.Delete(""), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(session_.PutShape("b", CreaturePolygon(0), false),
              FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(session_.DeleteShape("a"), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(session_.SetPlacements({}, ""), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(session_.SetCorrespondences({}, ""), FailsWith(ErrorCode::kSessionNotFound));
  Limits limits;
  limits.concurrent_builds = 0;
  BuildPool pool(limits);
  EXPECT_THAT(session_.StartBuild({}, pool), FailsWith(ErrorCode::kSessionNotFound));
  EXPECT_THAT(session_.FindShape("a"), Succeeds());
}

}  // namespace
}  // namespace posespace
