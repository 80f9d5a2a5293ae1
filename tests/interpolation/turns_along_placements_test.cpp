// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "interpolation/rigid_blend.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TurnsAlongPlacements, AreZeroWhenRotationsAreClose) {
  EXPECT_EQ(TurnsAlongPlacements({0.0, 1.0, -1.0}, PointsOf("0 0, 1 0, 2 0")),
            (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(TurnsAlongPlacements({0.5}, PointsOf("0 0")), (std::vector<int>{0}));
}

TEST(TurnsAlongPlacements, KeepTurningAlongARow) {
  // A wheel that turns by 120 degrees a step, its rotations told within half a turn.
  std::vector<double> rotations;
  Points placements(7, 2);
  for (int i = 0; i < 7; ++i) {
    rotations.push_back(std::remainder(i * 2.0 * kPi / 3.0, 2.0 * kPi));
    placements.row(i) << i, 0.5 * i;
  }
  EXPECT_EQ(TurnsAlongPlacements(rotations, placements), (std::vector<int>{0, 0, 1, 1, 1, 2, 2}));
}

TEST(TurnsAlongPlacements, FollowNeighboursNotTheOrderOfPoses) {
  // In a row at 0, 1, 2, 3: rotations 0, 2, 4, 6.
  const std::vector<double> rotations{0.0, 6.0 - 2.0 * kPi, 2.0, 4.0 - 2.0 * kPi};
  EXPECT_EQ(TurnsAlongPlacements(rotations, PointsOf("0 0, 3 0, 1 0, 2 0")),
            (std::vector<int>{0, 1, 0, 1}));
}

TEST(TurnsAlongPlacements, LeaveHalfATurnAlone) {
  const Points placements = PointsOf("0 0, 1 0");
  EXPECT_EQ(TurnsAlongPlacements({0.0, kPi}, placements), (std::vector<int>{0, 0}));
  EXPECT_EQ(TurnsAlongPlacements({0.0, kPi + 1e-12}, placements), (std::vector<int>{0, 0}));
  EXPECT_EQ(TurnsAlongPlacements({0.0, -kPi}, placements), (std::vector<int>{0, 0}));
  EXPECT_EQ(TurnsAlongPlacements({0.0, kPi + 1e-3}, placements), (std::vector<int>{0, -1}));
}

TEST(TurnsAlongPlacements, DoNotDependOnTheUnitOfPlacements) {
  std::mt19937 random(3);
  std::vector<double> rotations;
  Points placements(12, 2);
  for (int i = 0; i < 12; ++i) {
    rotations.push_back(i == 0 ? 0.0 : Uniform(-kPi, kPi, &random));
    placements.row(i) << Uniform(-1, 1, &random), Uniform(-1, 1, &random);
  }
  const std::vector<int> turns = TurnsAlongPlacements(rotations, placements);
  EXPECT_EQ(turns[0], 0);
  for (const double scale : {1e-200, 1e-6, 1e6, 1e200}) {
    EXPECT_EQ(TurnsAlongPlacements(rotations, scale * placements), turns);
  }
}

TEST(TurnsAlongPlacements, MakeABlendRollOnInsteadOfBack) {
  std::vector<Deformation> rolls;
  for (int i = 0; i < 4; ++i) rolls.push_back(Moved(2.0 * i, {5.0 * i, 0.0}));
  const CompatibleMesh mesh = StripMesh(4, 4, 1.0, rolls);
  const Points placements = PointsOf("0 0, 1 0, 2 0, 3 0");
  const auto unturned = RigidBlend::Prepare(mesh);
  ASSERT_TRUE(unturned);
  const auto blend =
      RigidBlend::Prepare(mesh, TurnsAlongPlacements(unturned->mean_rotations(), placements));
  ASSERT_TRUE(blend);
  const Points vertices = blend->At(Eigen::Vector4d(0.0, 0.0, 0.5, 0.5));
  const Point along = vertices.row(mesh.num_vertices() - 1) - vertices.row(4);
  EXPECT_NEAR(std::remainder(std::atan2(along.y(), along.x()) - 5.0, 2.0 * kPi), 0.0, 1e-12);
}

}  // namespace
}  // namespace posespace
