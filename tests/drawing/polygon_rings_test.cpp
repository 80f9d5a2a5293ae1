// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "drawing/outline.h"
#include "geometry/polygon.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Rings = std::vector<Points>;

Points Reversed(const Points& ring) { return ring.colwise().reverse(); }

Points RegularPolygon(int corners, double radius) {
  Points ring(corners, 2);
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * M_PI * k / corners;
    ring.row(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return ring;
}

TEST(OutlineFromRings, OrientsTheOuterRingPositivelyAndHolesNegatively) {
  const Points square = PointsOf("0 0, 10 0, 10 10, 0 10");
  const Points hole = PointsOf("2 2, 4 2, 4 4, 2 4");
  for (const Points& outer : {square, Reversed(square)}) {
    for (const Points& inner : {hole, Reversed(hole)}) {
      const auto outline = OutlineFromRings(outer, Rings{inner});
      ASSERT_TRUE(outline) << outline.error().message;
      EXPECT_DOUBLE_EQ(SignedArea(outline->outer), 100.0);
      ASSERT_EQ(outline->holes.size(), 1u);
      EXPECT_DOUBLE_EQ(SignedArea(outline->holes[0]), -4.0);
      EXPECT_EQ(outline->holes_filled, 1);
      EXPECT_EQ(outline->colours.rows(), 0);
    }
  }
}

TEST(OutlineFromRings, KeepsTheRowsOfAPositiveRingAsTheyAre) {
  const Points ring = PointsOf("5 5, 9 1, 12 7, 6 11");
  const auto outline = OutlineFromRings(ring, {});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_EQ(outline->outer, ring);
}

TEST(OutlineFromRings, RemovesRepeatedAndNeedlessPoints) {
  const Points ring =
      PointsOf("5 0, 5 0, 10 0, 10 0, 10 5, 10 10, 7 10, 3 10, 0 10, 0 0, 0 0, 2 0, 5 0");
  const auto outline = OutlineFromRings(ring, {});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_EQ(outline->outer.rows(), 4);
  EXPECT_DOUBLE_EQ(SignedArea(outline->outer), 100.0);
}

TEST(OutlineFromRings, SaysWhatWasDropped) {
  const auto outline =
      OutlineFromRings(PointsOf("0 0, 4 0, 4 0, 4 0, 10 0, 10 10, 5 10, 0 10, 0 0, 0 0"),
                       Rings{PointsOf("2 2, 4 2, 4 2, 4 4")});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_THAT(
      outline->warnings,
      ElementsAre("the outline: 2 repetitions of the first point at the end were dropped",
                  "the outline: 2 repeated points were dropped",
                  "the outline: 2 points within straight runs were dropped",
                  "hole 0: 1 repeated point was dropped",
                  "1 hole was filled; its transparency is kept", HasSubstr("upright rectangle")));
  EXPECT_THAT(OutlineFromRings(PointsOf("0 0, 9 0, 9 9"), {})->warnings, IsEmpty());
}

TEST(OutlineFromRings, FillsARingThatCrossesItselfByTheNonZeroRuleAndRetracesIt) {
  struct Case {
    const char* ring;
    double area;
    const char* said;
  };
  for (const Case& c : {
           // Two lobes that run opposite ways, whose signed areas cancel.
           Case{"0 0, 0 0, 100 100, 100 0, 0 100", 5000.0, "edge 1 meets edge 3 near (50, 50)"},
           // A square run around twice, then a pentagram, whose middle is surrounded twice.
           Case{"0 0, 100 0, 100 100, 0 100, 1 1, 99 1, 99 99, 1 99", 10000.0, "edge"},
           Case{"50 0, 79.39 90.45, 2.447 34.55, 97.55 34.55, 20.61 90.45", 2806.0, "edge"},
           // A spike, and a ring that touches itself.
           Case{"0 0, 100 0, 200 0, 100 0, 100 100", 5000.0, "edge"},
           Case{"0 0, 100 0, 100 100, 50 0, 0 100", 5000.0, "near (50, 0)"},
       }) {
    const auto outline = OutlineFromRings(PointsOf(c.ring), {});
    ASSERT_TRUE(outline) << outline.error().message;
    EXPECT_TRUE(IsSimple(outline->outer));
    const double inner = outline->holes.empty() ? 0.0 : SignedArea(outline->holes[0]);
    // Widened by about 2.5 of 512 points all around.
    EXPECT_NEAR(SignedArea(outline->outer) + inner, c.area, 0.15 * c.area) << c.ring;
    EXPECT_GT(SignedArea(outline->outer), c.area) << c.ring;
    EXPECT_THAT(outline->warnings, Contains(AllOf(HasSubstr(c.said), HasSubstr("non-zero rule"))));
    EXPECT_EQ(outline->colours.rows(), 0);
  }
}

TEST(OutlineFromRings, RetracesWhereTheRingsLie) {
  Points bow = PointsOf("0 0, 10 10, 10 0, 0 10");
  const auto near = OutlineFromRings(bow, {});
  bow *= 1e-3;
  bow.rowwise() += Eigen::RowVector2d(-5e5, 7e5);
  const auto far = OutlineFromRings(bow, {});
  ASSERT_TRUE(near && far);
  EXPECT_NEAR(SignedArea(far->outer) * 1e6, SignedArea(near->outer), 0.5);
  EXPECT_EQ(Locate({-5e5 + 0.002, 7e5 + 0.005}, far->outer), 1);
  EXPECT_EQ(Locate({-5e5 + 0.005, 7e5 + 0.002}, far->outer), -1);
}

TEST(OutlineFromRings, TakesAHoleThatCrossesItselfOutOfTheFilling) {
  const Points square = PointsOf("0 0, 100 0, 100 100, 0 100");
  const auto outline = OutlineFromRings(square, Rings{PointsOf("20 20, 80 80, 80 20, 20 80")});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_EQ(outline->holes_filled, 2);
  EXPECT_THAT(outline->warnings, Contains(HasSubstr("hole 0 crosses itself (edge 0 meets edge 2")));
}

TEST(OutlineFromRings, TracesARingOfThousandsOfLobes) {
  constexpr int kPoints = 20'000;
  Points ring(kPoints, 2);
  for (int k = 0; k < kPoints; ++k) {  // a rose that runs over itself again and again
    const double angle = 2 * M_PI * 997.0 * k / kPoints, radius = 300 + 200 * std::cos(2.7 * angle);
    ring.row(k) << 500 + radius * std::cos(angle), 500 + radius * std::sin(angle);
  }
  const auto outline = OutlineFromRings(ring, {});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_TRUE(IsSimple(outline->outer));
}

TEST(OutlineFromRings, KeepsEveryPointOfASimpleRingHoweverManyLobesItHas) {
  constexpr int kPoints = 20'000;
  Points ring(kPoints, 2);
  for (int k = 0; k < kPoints; ++k) {
    const double angle = 2 * M_PI * k / kPoints, radius = 400 + 50 * std::sin(300 * angle);
    ring.row(k) << 500 + radius * std::cos(angle), 500 + radius * std::sin(angle);
  }
  const auto outline = OutlineFromRings(ring, {});
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_EQ(outline->outer, ring);
  EXPECT_THAT(outline->warnings, IsEmpty());
}

TEST(OutlineFromRings, RefusesACrossingRingOfWhichNothingIsLeft) {
  const Points there_and_back = PointsOf("0 0, 10 0, 10 10, 10 0");
  EXPECT_THAT(OutlineFromRings(there_and_back, {}),
              FailsSaying(ErrorCode::kOutlineEmpty, "the outline crosses itself (edge"));
  const auto refused = OutlineFromRings(there_and_back, {});
  EXPECT_EQ(refused.error().where[0].field, "outer");
}

TEST(OutlineFromRings, RefusesRingsWithoutArea) {
  for (const char* ring :
       {"", "1 1", "1 1, 2 2", "1 1, 2 2, 1 1, 2 2", "0 0, 4 0, 2 0", "0 0, 4 0, 2 0, 6 0",
        "3 3, 3 3, 3 3, 3 3", "0 0, 1e-4 0, 1e-4 1e-4, 0 1e-4"}) {
    EXPECT_THAT(OutlineFromRings(PointsOf(ring), {}), FailsWith(ErrorCode::kOutlineTooSmall))
        << ring;
  }
  EXPECT_TRUE(OutlineFromRings(PointsOf("0 0, 1e-2 0, 1e-2 1e-2, 0 1e-2"), {}));
}

TEST(OutlineFromRings, RefusesCoordinatesThatAreNotFiniteOrTooFar) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {infinity, -infinity, std::nan(""), 1.0001e6, -1e300}) {
    Points ring = PointsOf("0 0, 10 0, 10 10, 0 10");
    ring(2, 1) = bad;
    const auto outline = OutlineFromRings(ring, {});
    ASSERT_THAT(outline, FailsSaying(ErrorCode::kInvalidOption, "point 2"));
    EXPECT_EQ(outline.error().where[0].field, "outer[2]");
    const auto as_hole = OutlineFromRings(PointsOf("0 0, 20 0, 20 20, 0 20"), Rings{ring});
    ASSERT_THAT(as_hole, FailsSaying(ErrorCode::kInvalidOption, "hole 0"));
    EXPECT_EQ(as_hole.error().where[0].field, "holes[0][2]");
  }
  EXPECT_TRUE(OutlineFromRings(PointsOf("-1e6 -1e6, 1e6 -1e6, 1e6 1e6"), {}));
}

TEST(OutlineFromRings, CountsPointsAgainstTheLimit) {
  const Points ring = RegularPolygon(100, 50.0);
  EXPECT_TRUE(OutlineFromRings(ring, {}, {.max_points = 100}));
  EXPECT_THAT(OutlineFromRings(ring, {}, {.max_points = 99}),
              FailsSaying(ErrorCode::kOutlineTooLong, "at most 99"));
  const Rings holes(40, PointsOf("0 0, 1 0, 1 1"));
  EXPECT_THAT(OutlineFromRings(ring, holes, {.max_points = 119}),
              FailsSaying(ErrorCode::kOutlineTooLong, "holes"));
}

TEST(OutlineFromRings, WantsHolesInsideTheOutlineAndApart) {
  const Points square = PointsOf("0 0, 10 0, 10 10, 0 10");
  const Points hole = PointsOf("2 2, 6 2, 6 6, 2 6");
  EXPECT_TRUE(OutlineFromRings(square, Rings{hole, PointsOf("7 7, 8 7, 8 8")}));
  EXPECT_THAT(OutlineFromRings(square, Rings{PointsOf("8 2, 12 2, 12 6, 8 6")}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "hole 0: edge"));
  EXPECT_THAT(OutlineFromRings(square, Rings{PointsOf("12 2, 16 2, 16 6")}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "outside"));
  EXPECT_THAT(OutlineFromRings(square, Rings{hole, PointsOf("3 3, 4 3, 4 4")}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "hole 1 lies inside hole 0"));
  EXPECT_THAT(OutlineFromRings(square, Rings{hole, PointsOf("5 5, 8 5, 8 8, 5 8")}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "of hole 0 near"));
}

double PaintedArea(const Texture& texture) {
  double sum = 0.0;
  for (std::size_t k = 3; k < texture.image.rgba.size(); k += 4) sum += texture.image.rgba[k];
  return sum / 255.0 / (texture.scale * texture.scale);
}

TEST(PaintRings, PaintsExactlyTheAreaBetweenTheRings) {
  const auto outline =
      OutlineFromRings(RegularPolygon(90, 37.0),
                       Rings{PointsOf("-9 -7, 11.3 -4, 3 13.7"),
                             RegularPolygon(30, 2.0).rowwise() + Eigen::RowVector2d(-20, 10)});
  ASSERT_TRUE(outline) << outline.error().message;
  const double area =
      SignedArea(outline->outer) + SignedArea(outline->holes[0]) + SignedArea(outline->holes[1]);
  for (const int size : {32, 200, 512}) {
    EXPECT_NEAR(PaintedArea(PaintRings(outline->outer, outline->holes, size)), area, 0.002 * area)
        << size;
  }
}

TEST(PaintRings, SaysWhereItsTexelsLie) {
  const Points ring = PointsOf("1000 -500, 1200 -500, 1200 -400, 1100 -450, 1000 -400");
  const auto outline = OutlineFromRings(ring, {});
  ASSERT_TRUE(outline) << outline.error().message;
  const Texture texture = PaintRings(outline->outer, outline->holes);
  EXPECT_EQ(texture.image.width, 512 + 4);
  const auto alpha = [&](double x, double y) {
    const Point texel = (Point(x, y) - texture.origin) * texture.scale;
    return static_cast<int>(
        texture.image.at(static_cast<int>(texel.x()), static_cast<int>(texel.y()))[3]);
  };
  EXPECT_EQ(alpha(1001, -499), 255);
  EXPECT_EQ(alpha(1199, -405), 255);
  EXPECT_EQ(alpha(1100, -452), 255);
  EXPECT_EQ(alpha(1100, -447), 0);
  EXPECT_EQ(alpha(999.5, -450), 0);
}

TEST(PaintRings, TakesThinAndFarRings) {
  for (const char* ring : {"-1e6 -1e6, 1e6 -1e6, 1e6 1e6", "0 0, 1e6 0, 1e6 1e-6, 0 1e-6",
                           "1e6 1e6, 999999.99 1e6, 999999.99 999999.99"}) {
    const auto outline = OutlineFromRings(PointsOf(ring), {});
    ASSERT_TRUE(outline) << outline.error().message;
    const Texture texture = PaintRings(outline->outer, outline->holes, 128);
    EXPECT_LE(std::max(texture.image.width, texture.image.height), 128 + 5);
    const double texel_area = 1.0 / (texture.scale * texture.scale);
    EXPECT_NEAR(PaintedArea(texture), SignedArea(outline->outer), texel_area) << ring;
  }
}

}  // namespace
}  // namespace posespace
