// SPDX-License-Identifier: Apache-2.0
#include "interpolation/rigid_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/polygon.h"
#include "interpolation/triangle_maps.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kPi = std::numbers::pi;

RigidBlend Prepared(const CompatibleMesh& mesh, std::vector<int> turns = {}) {
  auto blend = RigidBlend::Prepare(mesh, std::move(turns));
  EXPECT_TRUE(blend) << blend.error().message;
  return *blend;
}

Eigen::VectorXd Unit(int count, int i) { return Eigen::VectorXd::Unit(count, i); }

Points Transformed(const Points& points, const Deformation& move) {
  Points moved(points.rows(), 2);
  for (Eigen::Index v = 0; v < points.rows(); ++v) moved.row(v) = move(points.row(v).transpose());
  return moved;
}

Point CentroidOf(const Triangles& triangles, const Points& vertices) {
  Point moment = Point::Zero();
  double area = 0.0;
  for (const auto& t : triangles.rowwise()) {
    const Point a = vertices.row(t[0]), b = vertices.row(t[1]), c = vertices.row(t[2]);
    moment += Cross(a, b, c) * (a + b + c) / 3.0;
    area += Cross(a, b, c);
  }
  return moment / area;
}

// A body with four limbs in four poses, valid in each.
CompatibleMesh Limbs(unsigned seed, double most = 1.0) {
  std::mt19937 random(seed);
  CompatibleMesh mesh = PlusMesh(2, RandomLimbs(4, most, &random));
  for (const Points& pose : mesh.poses) EXPECT_EQ(CountFolds(mesh.triangles, pose), 0);
  return mesh;
}

// A square in two halves, and a triangle on one side of it whose height is some sides, in two poses
// of which the second is twice as large.
CompatibleMesh SquareWithATip(double height_first, double height_second) {
  CompatibleMesh mesh;
  mesh.poses.push_back(PointsOf("0 0, 10 0, 10 10, 0 10, 10 5"));
  mesh.poses.push_back(PointsOf("0 0, 20 0, 20 20, 0 20, 20 10"));
  mesh.poses[0](4, 0) += 10.0 * height_first;
  mesh.poses[1](4, 0) += 20.0 * height_second;
  mesh.triangles.resize(3, 3);
  mesh.triangles << 0, 1, 2, 0, 2, 3, 1, 4, 2;
  return mesh;
}

TEST(MeasureTriangles, WeighsByAreaWhatIsAsLargeInAllPoses) {
  for (const double height : {1.0, 0.01}) {
    const TriangleMaps maps = MeasureTriangles(SquareWithATip(height, height), RestShape::kMean);
    EXPECT_LT((maps.masses - maps.areas).norm(), 1e-9 * maps.areas.norm());
  }
}

TEST(MeasureTriangles, WeighsMoreWhatIsSmallInOnePose) {
  const TriangleMaps maps = MeasureTriangles(SquareWithATip(1.0, 0.04), RestShape::kMean);
  const double least = 0.02 / 1.02;  // the tip's share of the second pose
  const double smaller = maps.areas[2] / maps.areas.sum() / least;
  EXPECT_NEAR(maps.masses[2], maps.areas[2] * std::pow(smaller, 2.0 / 3.0), 1e-9 * maps.areas[2]);
  EXPECT_GT(maps.masses[2], 2.0 * maps.areas[2]);
}

TEST(MeasureTriangles, WeighsNothingMoreThanSixteenTimesItsArea) {
  const TriangleMaps maps = MeasureTriangles(SquareWithATip(1.0, 1e-6), RestShape::kMean);
  EXPECT_NEAR(maps.masses[2], 16.0 * maps.areas[2], 1e-9 * maps.areas[2]);
  EXPECT_LE((maps.masses.array() / maps.areas.array()).maxCoeff(), 16.0 * (1.0 + 1e-12));
}

TEST(RigidBlend, ReproducesEachPose) {
  const CompatibleMesh mesh = Limbs(1);
  const RigidBlend blend = Prepared(mesh, {0, 1, -2, 0});
  for (const auto method : {BlendMethod::kRigid, BlendMethod::kLinear, BlendMethod::kPaper}) {
    for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite, ShearLimit::kOff}) {
      for (const int refits : {0, 1, 3}) {
        for (int i = 0; i < 4; ++i) {
          const Points vertices =
              blend.At(Unit(4, i), {method, limit, refits, StretchBlend::kLinear});
          EXPECT_LT(Apart(vertices, mesh.poses[i]), 1e-9);
        }
      }
    }
  }
}

TEST(RigidBlend, ReproducesNeedlesAndASinglePose) {
  CompatibleMesh mesh;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 2, 1, 3;
  mesh.poses = {PointsOf("0 0, 100 0, 50 1e-5, 100 80"), PointsOf("0 0, 0 100, -2e-5 50, -30 120")};
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(CountFolds(mesh.triangles, mesh.poses[i]), 0);
    EXPECT_LT(Apart(Prepared(mesh).At(Unit(2, i)), mesh.poses[i]), 1e-7);
  }
  mesh.poses.resize(1);
  EXPECT_LT(Apart(Prepared(mesh).At(Unit(1, 0)), mesh.poses[0]), 1e-7);
}

TEST(RigidBlend, OfTwoPosesThatDifferByAMotionIsAMotion) {
  const CompatibleMesh mesh = StripMesh(6, 3, 1.0, {Moved(0.0, {0, 0}), Moved(2.0, {30, -10})});
  const RigidBlend blend = Prepared(mesh);
  const Point centre(3.0, 0.0);
  for (const double w : {-0.3, 0.25, 0.5, 1.4}) {
    const Points vertices = blend.At(Eigen::Vector2d(1.0 - w, w));
    const Point place = (1.0 - w) * centre + w * Moved(2.0, {30, -10})(centre);
    const Points expected = Transformed(
        mesh.poses[0], [&](const Point& p) -> Point { return Moved(2.0 * w, place)(p - centre); });
    EXPECT_LT(Apart(vertices, expected), 1e-9);
  }
}

TEST(RigidBlend, MovesAlongWhenAllPosesMoveTogether) {
  const CompatibleMesh mesh = Limbs(2);
  CompatibleMesh moved = mesh;
  const Deformation motion = Moved(2.5, {7, -3});
  for (Points& pose : moved.poses) pose = Transformed(pose, motion);
  const Eigen::Vector4d weights(0.4, 0.5, 0.3, -0.2);
  for (const auto method : {BlendMethod::kRigid, BlendMethod::kPaper}) {
    const Points expected = Transformed(Prepared(mesh).At(weights, {.method = method}), motion);
    EXPECT_LT(Apart(Prepared(moved).At(weights, {.method = method}), expected), 1e-11);
  }
}

TEST(RigidBlend, IsUnmovedByTheOrderOfPoses) {
  const CompatibleMesh mesh = Limbs(3);
  CompatibleMesh reordered = mesh;
  reordered.poses = {mesh.poses[2], mesh.poses[0], mesh.poses[3], mesh.poses[1]};
  const Eigen::Vector4d weights(0.4, 0.5, 0.3, -0.2);
  const Eigen::Vector4d reordered_weights(0.3, 0.4, -0.2, 0.5);
  const Points expected = Prepared(mesh).At(weights);
  EXPECT_LT(Apart(Prepared(reordered).At(reordered_weights), expected), 1e-11);
  // The paper's form depends on its base pose: the test would see a difference.
  EXPECT_GT(Apart(Prepared(reordered).At(reordered_weights, {.method = BlendMethod::kPaper}),
                  Prepared(mesh).At(weights, {.method = BlendMethod::kPaper})),
            1e-4);
}

TEST(RigidBlend, PutsTheCentroidAtTheMeanOfThePosesCentroids) {
  const CompatibleMesh mesh = Limbs(4);
  const Eigen::Vector4d weights(0.1, 0.6, 0.5, -0.2);
  Point expected = Point::Zero();
  for (int i = 0; i < 4; ++i) expected += weights[i] * CentroidOf(mesh.triangles, mesh.poses[i]);
  for (const auto method : {BlendMethod::kRigid, BlendMethod::kPaper}) {
    const Points vertices = Prepared(mesh).At(weights, {.method = method});
    EXPECT_LT((CentroidOf(mesh.triangles, vertices) - expected).norm(), 1e-12);
  }
}

TEST(RigidBlend, LinearIsTheWeightedSum) {
  const CompatibleMesh mesh = Limbs(5);
  const Eigen::Vector4d weights(0.7, -0.3, 0.2, 0.4);
  Points expected = Points::Zero(mesh.num_vertices(), 2);
  for (int i = 0; i < 4; ++i) expected += weights[i] * mesh.poses[i];
  EXPECT_LT(Apart(Prepared(mesh).At(weights, {.method = BlendMethod::kLinear}), expected), 1e-13);
}

TEST(RigidBlend, RollsAStripThroughTwoAndAHalfTurns) {
  const CompatibleMesh mesh = StripMesh(80, 2, 0.5, {Moved(0.0, {0, 0}), RolledUp});
  ASSERT_EQ(CountFolds(mesh.triangles, mesh.poses[1]), 0);
  const RigidBlend blend = Prepared(mesh);
  for (const double w : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    const Eigen::Vector2d weights(1.0 - w, w);
    const Points vertices = blend.At(weights);
    EXPECT_EQ(CountFolds(mesh.triangles, vertices), 0);
    EXPECT_LT(EdgeDistortion(mesh, vertices, weights), 0.005);
    const Points linear = blend.At(weights, {.method = BlendMethod::kLinear});
    EXPECT_GT(EdgeDistortion(mesh, linear, weights), 0.05);
  }
}

TEST(RigidBlend, BendsABarEvenlyThroughThreeHundredDegrees) {
  const double angle = 300.0 * kPi / 180.0;
  const CompatibleMesh mesh = StripMesh(60, 4, 0.2, {Bent(12.0, 0.0), Bent(12.0, angle)});
  const RigidBlend blend = Prepared(mesh);
  for (const double w : {0.2, 0.5, 0.8}) {
    const Eigen::Vector2d weights(1.0 - w, w);
    const Points vertices = blend.At(weights);
    EXPECT_EQ(CountFolds(mesh.triangles, vertices), 0);
    EXPECT_LT(EdgeDistortion(mesh, vertices, weights), 0.005);
    const Points bent = StripMesh(60, 4, 0.2, {Bent(12.0, w * angle)}).poses[0];
    // The same shape, wherever it lies: compare all distances from three corners.
    for (const Eigen::Index corner : {Eigen::Index{0}, Eigen::Index{4}, vertices.rows() - 1}) {
      const Eigen::VectorXd found =
          (vertices.rowwise() - Eigen::RowVector2d(vertices.row(corner))).rowwise().norm();
      const Eigen::VectorXd expected =
          (bent.rowwise() - Eigen::RowVector2d(bent.row(corner))).rowwise().norm();
      EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 0.03);
    }
  }
}

TEST(RigidBlend, KeepsEdgeLengthsBetweenSimilarSilhouettes) {
  for (unsigned seed = 10; seed < 18; ++seed) {
    const CompatibleMesh mesh = Limbs(seed, 0.9);
    const RigidBlend blend = Prepared(mesh);
    std::mt19937 random(seed);
    for (int k = 0; k < 10; ++k) {
      const Eigen::VectorXd weights = RandomWeights(4, &random);
      const Points vertices = blend.At(weights);
      EXPECT_EQ(CountFolds(mesh.triangles, vertices), 0);
      EXPECT_LT(EdgeDistortion(mesh, vertices, weights), 0.04);
    }
  }
}

TEST(RigidBlend, ExtrapolatesWithoutFolds) {
  int folds_without_limit = 0;
  for (unsigned seed = 20; seed < 26; ++seed) {
    const CompatibleMesh mesh = Limbs(seed, 0.9);
    const RigidBlend blend = Prepared(mesh);
    std::mt19937 random(seed);
    for (int k = 0; k < 10; ++k) {
      Eigen::VectorXd weights(4);
      do {
        for (int i = 0; i < 3; ++i) weights[i] = Uniform(-0.5, 1.6, &random);
        weights[3] = 1.0 - weights.head(3).sum();
      } while (weights[3] < -0.5 || weights[3] > 1.6);
      for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite}) {
        EXPECT_EQ(CountFolds(mesh.triangles, blend.At(weights, {.shear_limit = limit})), 0);
      }
      folds_without_limit +=
          CountFolds(mesh.triangles, blend.At(weights, {.shear_limit = ShearLimit::kOff}));
    }
  }
  RecordProperty("folds_without_limit", folds_without_limit);
}

TEST(RigidBlend, LimitsShearWhereRawWeightsFold) {
  // Pose 1 is half as wide: at w = 2.5 raw stretches would be negative.
  const CompatibleMesh mesh =
      StripMesh(4, 4, 1.0, {Moved(0.0, {0, 0}), [](const Point& p) -> Point {
                              return {0.5 * p.x(), p.y()};
                            }});
  const RigidBlend blend = Prepared(mesh);
  const Eigen::Vector2d weights(-1.5, 2.5);
  EXPECT_GT(CountFolds(mesh.triangles, blend.At(weights, {.shear_limit = ShearLimit::kOff})), 0);
  EXPECT_EQ(CountFolds(mesh.triangles, blend.At(weights)), 0);
}

TEST(RigidBlend, MixesStretchAsAsked) {
  // A square as large as itself and seven times as large.
  const CompatibleMesh mesh =
      StripMesh(2, 2, 1.0, {Moved(0.0, {0, 0}), [](const Point& p) -> Point { return 7.0 * p; }});
  const RigidBlend blend = Prepared(mesh);
  const auto side = [&](double w, StretchBlend stretch) {
    const Points vertices = blend.At(Eigen::Vector2d(1.0 - w, w), {.stretch = stretch});
    return (vertices.row(0) - vertices.row(2)).norm() / 2.0;
  };
  EXPECT_NEAR(side(0.5, StretchBlend::kLinear), 4.0, 1e-12);
  EXPECT_NEAR(side(0.5, StretchBlend::kLog), std::sqrt(7.0), 1e-12);
  EXPECT_NEAR(side(0.5, StretchBlend::kMetric), 5.0, 1e-12);
}

TEST(RigidBlend, ReproducesEachPoseHoweverStretchIsMixed) {
  const CompatibleMesh mesh = Limbs(12);
  const RigidBlend blend = Prepared(mesh);
  for (const auto stretch : {StretchBlend::kLog, StretchBlend::kMetric}) {
    for (int i = 0; i < 4; ++i) {
      EXPECT_LT(Apart(blend.At(Unit(4, i), {.stretch = stretch}), mesh.poses[i]), 1e-9);
    }
  }
}

TEST(RigidBlend, NeverInvertsByLogarithmsWhateverTheWeights) {
  const CompatibleMesh mesh =
      StripMesh(4, 4, 1.0, {Moved(0.0, {0, 0}), [](const Point& p) -> Point {
                              return {0.5 * p.x(), p.y()};
                            }});
  const RigidBlend blend = Prepared(mesh);
  for (const double w : {-3.0, 2.5, 6.0}) {
    const Points vertices = blend.At(Eigen::Vector2d(1.0 - w, w), {.shear_limit = ShearLimit::kOff,
                                                                   .stretch = StretchBlend::kLog});
    EXPECT_EQ(CountFolds(mesh.triangles, vertices), 0);
    EXPECT_NEAR((vertices.row(20) - vertices.row(0)).norm(), 4.0 * std::pow(0.5, w), 1e-9);
  }
}

TEST(RigidBlend, TurnsTheWayRoundThatTurnsSay) {
  const CompatibleMesh mesh = StripMesh(4, 2, 1.0, {Moved(0.0, {0, 0}), Moved(0.5 * kPi, {0, 0})});
  const Eigen::Vector2d half(0.5, 0.5);
  const auto direction = [&](const Points& vertices) {
    const Point along = vertices.row(mesh.num_vertices() - 1) - vertices.row(2);
    return std::atan2(along.y(), along.x());
  };
  EXPECT_NEAR(direction(Prepared(mesh).At(half)), 0.25 * kPi, 1e-12);
  EXPECT_NEAR(direction(Prepared(mesh, {0, -1}).At(half)), -0.75 * kPi, 1e-12);
  EXPECT_NEAR(std::remainder(direction(Prepared(mesh, {0, 2}).At(half)) - 2.25 * kPi, 2.0 * kPi),
              0.0, 1e-12);
  EXPECT_LT(Apart(Prepared(mesh, {5, 5}).At(half), Prepared(mesh).At(half)), 1e-12);
}

TEST(RigidBlend, TellsMeanRotationsWithinHalfATurn) {
  const CompatibleMesh mesh = StripMesh(
      4, 2, 1.0,
      {Moved(1.0, {0, 0}), Moved(3.0, {0, 0}), Moved(1.0 + kPi, {3, 4}), Moved(4.5, {0, 0})});
  const RigidBlend blend = Prepared(mesh, {0, 3, 0, -1});
  const std::vector<double> expected{0.0, 2.0, kPi, 3.5 - 2.0 * kPi};
  ASSERT_EQ(blend.mean_rotations().size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(blend.mean_rotations()[i], expected[i], 1e-12);
  EXPECT_EQ(blend.turns(), (std::vector<int>{0, 3, 0, -1}));
  EXPECT_EQ(Prepared(mesh).turns(), (std::vector<int>{0, 0, 0, 0}));
}

TEST(RigidBlend, UnwrapsAroundAHole) {
  // The rim turns against the hole by 0.8 of a turn: no rotation lies within half a turn of all.
  const Deformation swirl = [](const Point& p) {
    return Moved(-1.6 * kPi * 2.0 * (p.norm() - 0.5), {0, 0})(p);
  };
  const CompatibleMesh mesh = AnnulusMesh(60, 60, {Moved(0.0, {0, 0}), swirl});
  ASSERT_EQ(CountFolds(mesh.triangles, mesh.poses[1]), 0);
  const RigidBlend blend = Prepared(mesh);
  EXPECT_LT(Apart(blend.At(Unit(2, 1)), mesh.poses[1]), 1e-9);
  for (const double w : {0.3, 0.5, 0.7}) {
    EXPECT_EQ(CountFolds(mesh.triangles, blend.At(Eigen::Vector2d(1.0 - w, w))), 0);
  }
}

TEST(RigidBlend, HoldsAnAnchorAndMovesAllPartsWithIt) {
  CompatibleMesh mesh;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 3, 4, 5;
  mesh.poses = {PointsOf("0 0, 2 0, 0 2, 10 0, 12 0, 10 2"),
                PointsOf("0 0, 0 2, -2 0, 10 9, 12 9, 10 11")};  // the first turned about a corner
  const RigidBlend blend = Prepared(mesh);
  const Eigen::Vector2d half(0.5, 0.5);
  const Points free = blend.At(half);
  EXPECT_GT(free.row(0).norm(), 0.1);
  for (const auto method : {BlendMethod::kRigid, BlendMethod::kPaper, BlendMethod::kLinear}) {
    const Points held = blend.At(half, {.method = method, .anchor = MeshPoint{0, 0.0, 0.0}});
    EXPECT_LT(held.row(0).norm(), 1e-12) << "the corner that stays in both poses";
    if (method != BlendMethod::kRigid) continue;
    EXPECT_LT(Apart(held, free.rowwise() - free.row(0)), 1e-12);
  }
  for (int i = 0; i < 2; ++i) {
    const Points pose = blend.At(Eigen::Vector2d::Unit(i), {.anchor = MeshPoint{1, 0.3, 0.3}});
    EXPECT_LT(Apart(pose, mesh.poses[i]), 1e-12) << "poses stay exact";
  }
}

TEST(RigidBlend, PlacesSeparatePartsEachByItself) {
  CompatibleMesh mesh;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 3, 4, 5;
  mesh.poses = {PointsOf("0 0, 2 0, 0 2, 10 0, 12 0, 10 2"),
                PointsOf("0 0, 2 0, 0 2, 10 9, 12 9, 10 11")};
  const Points half = Prepared(mesh).At(Eigen::Vector2d(0.5, 0.5));
  EXPECT_LT(Apart(half, PointsOf("0 0, 2 0, 0 2, 10 4.5, 12 4.5, 10 6.5")), 1e-12);
}

TEST(RigidBlend, IsExactFarFromTheOrigin) {
  const CompatibleMesh mesh = Limbs(6);
  CompatibleMesh far = mesh;
  const Eigen::RowVector2d offset(1e5, -2e5);
  for (Points& pose : far.poses) pose.rowwise() += offset;
  const Eigen::Vector4d weights(0.4, 0.5, 0.3, -0.2);
  Points expected = Prepared(mesh).At(weights);
  expected.rowwise() += offset;
  EXPECT_LT(Apart(Prepared(far).At(weights), expected), 1e-9);
}

TEST(RigidBlend, ScalesWithTheDrawing) {
  const CompatibleMesh mesh = Limbs(7);
  const Eigen::Vector4d weights(0.4, 0.5, 0.3, -0.2);
  for (const double scale : {1e-9, 1e-3, 1e3, 1e9}) {
    CompatibleMesh scaled = mesh;
    for (Points& pose : scaled.poses) pose *= scale;
    for (const auto method : {BlendMethod::kRigid, BlendMethod::kPaper}) {
      const Points expected = scale * Prepared(mesh).At(weights, {.method = method});
      EXPECT_LT(Apart(Prepared(scaled).At(weights, {.method = method}), expected), 1e-10 * scale);
    }
  }
}

TEST(RigidBlend, KeepsAMirrorImageAMirrorImage) {
  const CompatibleMesh mesh = Limbs(8);
  CompatibleMesh mirrored = mesh;
  mirrored.triangles.col(1).swap(mirrored.triangles.col(2));
  for (Points& pose : mirrored.poses) pose.col(0) *= -1.0;
  const Eigen::Vector4d weights(0.4, 0.5, 0.3, -0.2);
  Points expected = Prepared(mesh).At(weights);
  expected.col(0) *= -1.0;
  EXPECT_LT(Apart(Prepared(mirrored).At(weights), expected), 1e-11);
}

TEST(RigidBlend, RefitsReduceDistortion) {
  // Opposite limbs' angles differ by more than they should for one linear solve.
  const CompatibleMesh mesh = Limbs(9, 2.0);
  const RigidBlend blend = Prepared(mesh);
  const Eigen::Vector4d weights(0.25, 0.25, 0.25, 0.25);
  const double without = EdgeDistortion(mesh, blend.At(weights, {.refits = 0}), weights);
  const double with = EdgeDistortion(mesh, blend.At(weights, {.refits = 3}), weights);
  EXPECT_LT(with, without);
}

TEST(RigidBlend, MovesSmoothlyWithTheWeights) {
  const CompatibleMesh mesh = Limbs(10);
  const RigidBlend blend = Prepared(mesh);
  const auto at = [&](double t) { return blend.At(Eigen::Vector4d(0.9 - t, t, 0.3, -0.2)); };
  // At multiples of 0.05 some weight crosses the ends of the shear limit's bands.
  constexpr double kStep = 1e-6;
  for (int k = -10; k <= 28; ++k) {
    const double t = 0.05 * k;
    const Points before = (at(t) - at(t - kStep)) / kStep, after = (at(t + kStep) - at(t)) / kStep;
    EXPECT_LT(Apart(before, after), 1e-3) << "at t = " << t;
    EXPECT_LT(after.rowwise().norm().maxCoeff(), 20.0);
  }
}

TEST(RigidBlend, RefusesWhatItCannotPrepare) {
  const CompatibleMesh mesh = Limbs(11);
  const auto wrong_turns = RigidBlend::Prepare(mesh, {0, 1});
  ASSERT_FALSE(wrong_turns);
  EXPECT_EQ(wrong_turns.error().code, ErrorCode::kSizeMismatch);

  CompatibleMesh flat;
  flat.triangles.resize(1, 3);
  flat.triangles << 0, 1, 2;
  flat.poses = {PointsOf("0 0, 1 1, 2 2"), PointsOf("0 0, 1 1, 2 2")};
  const auto degenerate = RigidBlend::Prepare(flat);
  ASSERT_FALSE(degenerate);
  EXPECT_EQ(degenerate.error().code, ErrorCode::kInternal);
  EXPECT_FALSE(RigidBlend::Prepare(CompatibleMesh{}));
}

TEST(CountFolds, CountsTrianglesThatAreNotPositive) {
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  EXPECT_EQ(CountFolds(triangles, PointsOf("0 0, 1 0, 1 1, 0 1")), 0);
  EXPECT_EQ(CountFolds(triangles, PointsOf("0 0, 1 0, 1 1, 1 0")), 1);
  EXPECT_EQ(CountFolds(triangles, PointsOf("0 0, 1 0, 1 1, 2 2")), 1);
  EXPECT_EQ(CountFolds(triangles, PointsOf("0 0, 1 1, 1 0, 0 -1")), 2);
}

}  // namespace
}  // namespace posespace
