// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_path.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Points Zigzag() { return (Points(4, 2) << 0, 0, 1, 2, 3, 2, 3, -1).finished(); }

Waypoints Timed(Points places, std::vector<double> times, bool loop = false) {
  return {std::move(places), std::move(times), loop, Easing::kUniform, {}};
}

// Differences of second order, so exact for the pieces of a cubic but for rounding.
Point Velocity(const PosePath& path, double t, double side) {
  constexpr double h = 1e-4;
  return side * (-3.0 * path.At(t) + 4.0 * path.At(t + side * h) - path.At(t + 2 * side * h)) /
         (2.0 * h);
}
Point Acceleration(const PosePath& path, double t, double side) {
  constexpr double h = 1e-3;
  return (2.0 * path.At(t) - 5.0 * path.At(t + side * h) + 4.0 * path.At(t + 2 * side * h) -
          path.At(t + 3 * side * h)) /
         (h * h);
}

TEST(PosePath, GoesThroughEveryWaypointAtItsTime) {
  const std::vector<double> times{0.5, 1.0, 3.0, 3.25};
  for (const bool loop : {false, true}) {
    const auto path = *PosePath::Fit(Timed(Zigzag(), times, loop));
    for (int k = 0; k < 4; ++k) {
      const Point expected = Zigzag().row(k);
      EXPECT_LT((path.At(times[static_cast<std::size_t>(k)] - 0.5) - expected).norm(), 1e-12);
    }
  }
}

TEST(PosePath, HasNoJumpInVelocityOrAcceleration) {
  for (const bool loop : {false, true}) {
    const auto path = *PosePath::Fit(Timed(Zigzag(), {0.0, 0.5, 2.0, 3.0}, loop));
    std::vector<double> joints{0.5, 2.0};
    if (loop) joints.insert(joints.end(), {3.0, path.duration(), 2.0 * path.duration()});
    for (const double t : joints) {
      EXPECT_LT((Velocity(path, t, 1) - Velocity(path, t, -1)).norm(), 1e-5) << t;
      EXPECT_LT((Acceleration(path, t, 1) - Acceleration(path, t, -1)).norm(), 1e-3) << t;
    }
  }
}

TEST(PosePath, IsStraightBetweenTwoPlaces) {
  const auto path = *PosePath::Fit(Timed((Points(2, 2) << 0, 0, 2, 4).finished(), {0.0, 2.0}));
  EXPECT_LT((path.At(0.5) - Point(0.5, 1.0)).norm(), 1e-12);
}

TEST(PosePath, RestsAtItsEndsAndGoesOnWhenLooped) {
  const auto open = *PosePath::Fit(Timed(Zigzag(), {0, 1, 2, 3}));
  EXPECT_EQ(open.At(-1.0), open.At(0.0));
  EXPECT_EQ(open.At(4.0), open.At(3.0));
  const auto loop = *PosePath::Fit(Timed(Zigzag(), {0, 1, 2, 3}, true));
  EXPECT_DOUBLE_EQ(loop.duration(), 4.0);
  EXPECT_LT((loop.At(4.75) - loop.At(0.75)).norm(), 1e-12);
  EXPECT_LT((loop.At(-0.25) - loop.At(3.75)).norm(), 1e-12);
}

TEST(PosePath, ALoopStartsAnywhereAlike) {
  const auto path = *PosePath::Fit({Zigzag(), {}, true, Easing::kUniform, 7.0});
  const Points turned = (Points(4, 2) << 1, 2, 3, 2, 3, -1, 0, 0).finished();
  const auto other = *PosePath::Fit({turned, {}, true, Easing::kUniform, 7.0});
  const double offset = 7.0 * std::sqrt(5.0) / (std::sqrt(5.0) + 2.0 + 3.0 + std::sqrt(10.0));
  for (double t = 0.0; t < 7.0; t += 0.1) {
    EXPECT_LT((path.At(t + offset) - other.At(t)).norm(), 1e-9);
  }
}

TEST(PosePath, GivesALegTimeByItsLengthAndASecondALegInAll) {
  const Points places = (Points(3, 2) << 0, 0, 1, 0, 4, 0).finished();
  const auto path = *PosePath::Fit({places, {}, false, Easing::kUniform, {}});
  EXPECT_DOUBLE_EQ(path.duration(), 2.0);
  EXPECT_LT((path.At(0.5) - Point(1, 0)).norm(), 1e-12);
  const auto loop = *PosePath::Fit({places, {}, true, Easing::kUniform, {}});
  EXPECT_DOUBLE_EQ(loop.duration(), 3.0);
}

TEST(PosePath, IsInvariantToMovingAndScalingSpace) {
  const auto path = *PosePath::Fit({Zigzag(), {}, false, Easing::kUniform, 3.0});
  const Points moved = (1e5 * Zigzag()).rowwise() + Eigen::RowVector2d(7e4, -3e4);
  const auto other = *PosePath::Fit({moved, {}, false, Easing::kUniform, 3.0});
  for (double t = 0.0; t <= 3.0; t += 0.1) {
    EXPECT_LT((1e5 * path.At(t) + Point(7e4, -3e4) - other.At(t)).norm(), 1e-8);
  }
}

TEST(PosePath, EasedStartsAndEndsAtRestAndMeetsItselfInTheMiddle) {
  Waypoints waypoints{Zigzag(), {}, false, Easing::kInOut, 3.0};
  const auto eased = *PosePath::Fit(waypoints);
  waypoints.easing = Easing::kUniform;
  const auto uniform = *PosePath::Fit(waypoints);
  EXPECT_LT(Velocity(eased, 0.0, 1).norm(), 1e-3);
  EXPECT_LT(Velocity(eased, 3.0, -1).norm(), 1e-3);
  EXPECT_LT((eased.At(1.5) - uniform.At(1.5)).norm(), 1e-12);
  EXPECT_LT((eased.At(3.0) - uniform.At(3.0)).norm(), 1e-12);
}

TEST(PosePath, OfOnePlaceRestsThere) {
  const Points place = (Points(1, 2) << 3, 4).finished();
  for (const bool loop : {false, true}) {
    const auto still = *PosePath::Fit({place, {}, loop, Easing::kUniform, {}});
    EXPECT_EQ(still.duration(), 0.0);
    EXPECT_EQ(still.At(1.0), Point(3, 4));
    const auto resting = *PosePath::Fit({place, {}, loop, Easing::kInOut, 2.0});
    EXPECT_EQ(resting.duration(), 2.0);
    EXPECT_EQ(resting.At(1.0), Point(3, 4));
  }
}

TEST(PosePath, RestsBetweenTimedWaypointsInOnePlace) {
  const Points places = (Points(2, 2) << 1, 1, 1, 1).finished();
  const auto path = *PosePath::Fit(Timed(places, {0.0, 1.0}));
  EXPECT_EQ(path.At(0.5), Point(1, 1));
}

TEST(PosePath, RefusesWhatIsNoPathNamingTheWaypoint) {
  const auto refused = [](const Waypoints& waypoints, const char* field) {
    EXPECT_THAT(PosePath::Fit(waypoints), FailsWith(ErrorCode::kPathInvalid, field));
  };
  const auto untimed = [](const char* places, std::optional<double> duration, bool loop = false) {
    return Waypoints{PointsOf(places), {}, loop, Easing::kUniform, duration};
  };
  refused({Points(0, 2), {}, false, Easing::kUniform, {}}, "waypoints");
  refused(untimed("0 0, 1 0, 1 0, 2 0", {}), "waypoints[2].at");
  refused(untimed("0 0, 1 0, 1 0", {}), "waypoints[2].at");
  refused(untimed("0 0, 1 0, 0 0", {}, true), "waypoints[0].at");
  refused(untimed("1 1, 1 1", {}), "waypoints[1].at");
  for (const double duration : {0.0, -1.0, 3600.001, kNan}) {
    refused(untimed("0 0, 1 0", duration), "duration");
  }
  refused(Timed(PointsOf("0 0, 1 0"), {0.0}), "waypoints");
  refused(Timed(PointsOf("0 0, 1 0"), {0.0, kNan}), "waypoints[1].time");
  refused(Timed(PointsOf("0 0, 1 0"), {-1.0, 1.0}), "waypoints[0].time");
  refused(Timed(PointsOf("0 0, 1 0, 2 0"), {0.0, 1.0, 1.0005}), "waypoints[2].time");
  refused({PointsOf("0 0, 1 0"), {0.0, 1.0}, false, Easing::kUniform, 2.0}, "duration");
}

TEST(PosePath, RefusesPlacesThatAreNotFiniteNamingThem) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 1e13}) {
    Points places = Zigzag();
    places(2, 1) = bad;
    EXPECT_THAT(PosePath::Fit({places, {}, false, Easing::kUniform, {}}),
                FailsWith(ErrorCode::kPoseNotFinite, "waypoints[2].at"));
  }
}

TEST(PosePath, TakesAThousandPlacesAndNoMore) {
  Points places(1'001, 2);
  for (int k = 0; k < 1'001; ++k) places.row(k) << k, k % 2;
  EXPECT_THAT(PosePath::Fit({places, {}, false, Easing::kUniform, {}}),
              FailsWith(ErrorCode::kPathInvalid));
  EXPECT_TRUE(PosePath::Fit({places.topRows(1'000), {}, true, Easing::kUniform, {}}));
}

}  // namespace
}  // namespace posespace
