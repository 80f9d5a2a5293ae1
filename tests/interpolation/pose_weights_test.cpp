// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_weights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <cmath>
#include <limits>
#include <numbers>

#include "interpolation/pose_lattice.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kPi = std::numbers::pi;

PoseWeights Fitted(const Points& placements, const PoseWeightsOptions& options = {}) {
  auto weights = PoseWeights::Fit(placements, options);
  EXPECT_TRUE(weights) << weights.error().message;
  return *weights;
}

// Seven poses without symmetry, their diameter about 3.
const Points kPlacements = PointsOf("0 0, 2.1 0.3, 2.4 1.9, 0.2 1.7, 1.1 0.9, 1.6 1.4, 0.7 -0.4");

double ErrorAtPlacements(const PoseWeights& weights, const Points& placements) {
  double error = 0.0;
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    const Eigen::VectorXd expected = Eigen::VectorXd::Unit(placements.rows(), i);
    const Eigen::VectorXd found = weights.At(placements.row(i).transpose());
    error = std::max(error, (found - expected).cwiseAbs().maxCoeff());
  }
  return error;
}

// The largest jump of the derivative along the line from a to b: between one-sided differences of
// second order at `count` places.
double DerivativeJump(const PoseWeights& weights, const Point& a, const Point& b, int count) {
  constexpr double kStep = 1e-6;
  const Point along = (b - a).normalized();
  const auto at = [&](double s) { return weights.At(a + s * along); };
  double jump = 0.0;
  for (int k = 1; k < count; ++k) {
    const double s = (b - a).norm() * k / count;
    const Eigen::VectorXd here = at(s);
    const Eigen::VectorXd after = -3.0 * here + 4.0 * at(s + kStep) - at(s + 2 * kStep);
    const Eigen::VectorXd before = 3.0 * here - 4.0 * at(s - kStep) + at(s - 2 * kStep);
    jump = std::max(jump, (after - before).cwiseAbs().maxCoeff() / (2 * kStep));
  }
  return jump;
}

TEST(PoseWeights, AreExactAtThePlacements) {
  EXPECT_LT(ErrorAtPlacements(Fitted(kPlacements), kPlacements), 1e-12);
}

TEST(PoseWeights, SumToOneInsideAndFarOutsideThePoses) {
  const PoseWeights weights = Fitted(kPlacements);
  std::mt19937 random(1);
  for (const double reach : {2.0, 10.0, 1e6, 1e300}) {
    for (int k = 0; k < 500; ++k) {
      const Point point(Uniform(-reach, reach, &random), Uniform(-reach, reach, &random));
      ASSERT_NEAR(weights.At(point).sum(), 1.0, 1e-12);
    }
  }
}

TEST(PoseWeights, OfOnePoseAreOneEverywhere) {
  const PoseWeights weights = Fitted(PointsOf("3 4"));
  EXPECT_EQ(weights.num_poses(), 1);
  for (const Point& point : {Point(3, 4), Point(-100, 7)}) {
    EXPECT_EQ(weights.At(point), Eigen::VectorXd::Ones(1));
  }
}

TEST(PoseWeights, OfTwoPosesAreEqualHalfway) {
  const Points placements = PointsOf("0 0, 0 1");
  const PoseWeights weights = Fitted(placements);
  EXPECT_LT(ErrorAtPlacements(weights, placements), 1e-12);
  for (const double x : {-0.3, 0.0, 0.2}) EXPECT_NEAR(weights.At(Point(x, 0.5))[0], 0.5, 1e-3);
  EXPECT_GT(weights.At(Point(0, 0.25))[0], 0.6);
  EXPECT_LT(weights.At(Point(0, 0.75))[0], 0.4);
}

TEST(PoseWeights, OfCollinearPosesAreWellDefined) {
  for (const char* text : {"0 0, 1 0, 2 0, 4 0", "0 0, 0 1, 0 3", "0 0, 1 1, 2 2, 5 5"}) {
    const Points placements = PointsOf(text);
    const PoseWeights weights = Fitted(placements);
    EXPECT_LT(ErrorAtPlacements(weights, placements), 1e-12);
    EXPECT_LT(weights.At(Point(1.5, 1.5)).cwiseAbs().maxCoeff(), 1.5);
  }
}

TEST(PoseWeights, AreExactAtCloseAndClusteredPlacements) {
  for (const double distance : {0.1, 0.03, 0.01, 0.0011}) {
    Points placements(9, 2);
    for (int i = 0; i < 7; ++i) {
      placements.row(i) << 0.3 + distance * std::cos(kPi * i / 3.0),
          0.4 + distance * std::sin(kPi * i / 3.0);
    }
    placements.row(6) << 0.3, 0.4;
    placements.row(7) << 0.0, 0.0;
    placements.row(8) << 0.6, 0.8;
    const PoseWeights weights = Fitted(placements);
    EXPECT_LT(ErrorAtPlacements(weights, placements), 1e-12) << distance;
    EXPECT_NEAR(weights.At(Point(0.31, 0.39)).sum(), 1.0, 1e-12);
  }
}

TEST(PoseWeights, AreSmoothAlongLinesInsideTheDomain) {
  const PoseWeights weights = Fitted(kPlacements);
  std::mt19937 random(2);
  for (int k = 0; k < 6; ++k) {
    const Point a(Uniform(-0.5, 3.0, &random), Uniform(-0.5, 2.0, &random));
    const Point b(Uniform(-0.5, 3.0, &random), Uniform(-0.5, 2.0, &random));
    EXPECT_LT(DerivativeJump(weights, a, b, 3001), 1e-4);
  }
}

TEST(PoseWeights, AreSmoothThroughThePlacements) {
  const PoseWeights weights = Fitted(kPlacements);
  for (Eigen::Index i = 0; i < kPlacements.rows(); ++i) {
    const Point place = kPlacements.row(i).transpose(), reach(0.1, 0.07);
    EXPECT_LT(DerivativeJump(weights, place - reach, place + reach, 2), 1e-4);
  }
}

TEST(PoseWeights, AreSmoothAcrossLatticeEdges) {
  // Rows of the lattice lie near these; a fine scan along a line crosses some hundred edges.
  const PoseWeights weights = Fitted(PointsOf("0 0, 1 0, 0 1, 1 1"));
  EXPECT_LT(DerivativeJump(weights, Point(0.2, 0.1), Point(0.4, 0.35), 20011), 1e-4);
}

TEST(PoseWeights, AreSmoothAcrossTheRimAndAtItsCorners) {
  // The domain is [-d/2, 1 + d/2]^2 with d = sqrt(2).
  const Points placements = PointsOf("0 0, 1 0, 0 1, 1 1, 0.6 0.3");
  const PoseWeights weights = Fitted(placements);
  const double low = -0.5 * std::numbers::sqrt2, high = 1.0 - low;
  for (const double t : {-0.5, 0.013, 0.4, 1.2}) {
    for (const double rim : {low, high}) {
      EXPECT_LT(DerivativeJump(weights, Point(rim - 0.1, t), Point(rim + 0.1, t), 2), 1e-4);
      EXPECT_LT(DerivativeJump(weights, Point(t, rim - 0.1), Point(t, rim + 0.1), 2), 1e-4);
      EXPECT_LT(DerivativeJump(weights, Point(rim - 0.1, t), Point(rim + 0.1, t + 0.1), 2), 1e-4);
      EXPECT_LT(DerivativeJump(weights, Point(t, rim), Point(t + 0.2, rim), 997), 1e-4);
    }
  }
  for (const double x : {low, high}) {
    for (const double y : {low, high}) {
      for (const Point& reach :
           {Point(0.1, 0.1), Point(0.1, -0.1), Point(0.1, 0), Point(0.02, 0.1)}) {
        const Point corner(x, y);
        EXPECT_LT(DerivativeJump(weights, corner - reach, corner + reach, 2), 1e-4);
      }
    }
  }
}

TEST(PoseWeights, AreSmoothOutside) {
  const PoseWeights weights = Fitted(kPlacements);
  EXPECT_LT(DerivativeJump(weights, Point(-4.0, -3.0), Point(-4.0, 5.0), 5003), 1e-4);
  EXPECT_LT(DerivativeJump(weights, Point(-4.0, -3.0), Point(6.0, 7.0), 5003), 1e-4);
  EXPECT_LT(DerivativeJump(weights, Point(-5.0, 6.0), Point(7.0, -2.0), 5003), 1e-4);
}

TEST(PoseWeights, AreThoseOfTheClosestPointOfTheRimOutside) {
  const PoseWeights weights = Fitted(PointsOf("0 0, 1 0, 0 1, 1 1, 0.6 0.3"));
  const double low = -0.5 * std::numbers::sqrt2;
  for (const double y : {-0.4, 0.2, 0.9}) {
    const Eigen::VectorXd rim = weights.At(Point(low, y));
    EXPECT_LT((weights.At(Point(-3.0, y)) - rim).norm(), 1e-9);
    EXPECT_LT((weights.At(Point(-1e9, y)) - rim).norm(), 1e-9);
  }
  EXPECT_LT((weights.At(Point(-9, -4)) - weights.At(Point(low, low))).norm(), 1e-9);
}

TEST(PoseWeights, DoNotDependOnTheUnitOrOriginOfPlacements) {
  const PoseWeights weights = Fitted(kPlacements);
  std::mt19937 random(3);
  for (const double scale : {1e-6, 0.37, 1e6, 1e150}) {
    const PoseWeights scaled = Fitted(scale * kPlacements);
    for (int k = 0; k < 100; ++k) {
      const Point point(Uniform(-2, 4, &random), Uniform(-2, 4, &random));
      ASSERT_LT((scaled.At(scale * point) - weights.At(point)).cwiseAbs().maxCoeff(), 1e-8);
    }
  }
  const Point offset(1e4, -3e4);
  const PoseWeights moved = Fitted(kPlacements.rowwise() + offset.transpose());
  for (int k = 0; k < 100; ++k) {
    const Point point(Uniform(-2, 4, &random), Uniform(-2, 4, &random));
    ASSERT_LT((moved.At(point + offset) - weights.At(point)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(PoseWeights, AreReorderedWithThePlacements) {
  const std::vector<int> order{3, 0, 6, 2, 5, 1, 4};
  Points reordered(7, 2);
  for (int i = 0; i < 7; ++i) reordered.row(i) = kPlacements.row(order[i]);
  const PoseWeights weights = Fitted(kPlacements), other = Fitted(reordered);
  for (const Point& point : {Point(1, 1), Point(0.3, 0.2), Point(-1, 2)}) {
    const Eigen::VectorXd expected = weights.At(point), found = other.At(point);
    for (int i = 0; i < 7; ++i) EXPECT_NEAR(found[i], expected[order[i]], 1e-9);
  }
}

TEST(PoseWeights, OfMirroredPlacementsAreMirrored) {
  // Poses 0 and 1, 2 and 3 are mirror images in x = 0; pose 4 lies on the axis.
  const Points placements = PointsOf("-1 0.1, 1 0.1, -0.6 1.3, 0.6 1.3, 0 0.5");
  const PoseWeights weights = Fitted(placements);
  for (const Point& point : {Point(0.5, 0.5), Point(0.2, 0.9), Point(1.4, -0.3), Point(0.9, 0.2)}) {
    const Eigen::VectorXd right = weights.At(point);
    const Eigen::VectorXd left = weights.At(Point(-point.x(), point.y()));
    const Eigen::VectorXd expected =
        (Eigen::VectorXd(5) << right[1], right[0], right[3], right[2], right[4]).finished();
    EXPECT_LT((left - expected).cwiseAbs().maxCoeff(), 5e-3);
  }
}

TEST(PoseWeights, HardlyDependOnTheDirectionOfTheAxes) {
  const PoseWeights weights = Fitted(kPlacements);
  for (const double angle : {0.3, 0.5 * kPi, 1.1}) {
    const Deformation turn = Moved(angle, {0, 0});
    Points turned(kPlacements.rows(), 2);
    for (Eigen::Index i = 0; i < turned.rows(); ++i) {
      turned.row(i) = turn(kPlacements.row(i).transpose());
    }
    const PoseWeights other = Fitted(turned);
    for (double x = 0.3; x < 2.0; x += 0.2) {
      for (double y = 0.3; y < 1.6; y += 0.2) {
        const Point point(x, y);
        EXPECT_LT((other.At(turn(point)) - weights.At(point)).cwiseAbs().maxCoeff(), 0.03);
      }
    }
  }
}

// The thin-plate spline through unit data at the placements: sum c_j r^2 log r plus a linear part.
class ThinPlate {
 public:
  explicit ThinPlate(const Points& placements) : placements_(placements) {
    const Eigen::Index n = placements.rows();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 3, n + 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      system.row(i) = Row(placements.row(i).transpose());
      system.col(i).tail(3) = system.row(i).tail(3).transpose();
    }
    solution_ = system.fullPivLu().solve(Eigen::MatrixXd::Identity(n + 3, n));
  }
  Eigen::VectorXd At(const Point& point) const { return (Row(point) * solution_).transpose(); }

 private:
  Eigen::RowVectorXd Row(const Point& point) const {
    const Eigen::Index n = placements_.rows();
    Eigen::RowVectorXd row(n + 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double r = (placements_.row(i).transpose() - point).norm();
      row[i] = r > 0.0 ? r * r * std::log(r) : 0.0;
    }
    row.tail(3) << 1.0, point.x(), point.y();
    return row;
  }
  Points placements_;
  Eigen::MatrixXd solution_;
};

TEST(PoseWeights, AreNearlyThinPlateSplinesAmongThePosesWithoutLevelling) {
  const Points placements = PointsOf("0 0, 1 0, 2 0, 0 1, 1.1 0.9, 2 1, 0 2, 1 2, 2 2");
  const PoseWeights weights = Fitted(placements, {.levelling = 100.0});
  const ThinPlate plate(placements);
  double sum = 0.0, largest = 0.0;
  int count = 0;
  for (double x = 0.05; x < 2.0; x += 0.1) {
    for (double y = 0.05; y < 2.0; y += 0.1) {
      const Eigen::ArrayXd difference = weights.At(Point(x, y)) - plate.At(Point(x, y));
      sum += difference.square().sum();
      largest = std::max(largest, difference.abs().maxCoeff());
      count += static_cast<int>(difference.size());
    }
  }
  EXPECT_LT(std::sqrt(sum / count), 0.01);
  EXPECT_LT(largest, 0.03);
}

TEST(PoseWeights, ReproduceLinearDataAmongThePosesWithoutLevelling) {
  const PoseWeights weights = Fitted(kPlacements, {.levelling = 100.0});
  for (double x = 0.3; x < 2.0; x += 0.2) {
    for (double y = 0.3; y < 1.6; y += 0.2) {
      const Point mean = kPlacements.transpose() * weights.At(Point(x, y));
      EXPECT_LT((mean - Point(x, y)).norm(), 0.01) << x << " " << y;
    }
  }
}

TEST(PoseWeights, LevelOutSoonerWithAShorterLength) {
  const Points placements = PointsOf("0 0, 1 0, 0 1, 1 1, 0.5 0.3");
  double last = std::numeric_limits<double>::infinity();
  for (const double levelling : {5.0, 1.0, 0.4, 0.2}) {
    const PoseWeights weights = Fitted(placements, {.levelling = levelling});
    double range = 0.0;
    for (double x = -0.7; x < 1.7; x += 0.05) {
      for (double y = -0.7; y < 1.7; y += 0.05) {
        range = std::max(range, weights.At(Point(x, y)).cwiseAbs().maxCoeff());
      }
    }
    EXPECT_LT(range, last);
    last = range;
  }
}

// The same energy on the same lattice, written down a second time: gradients by inverting edge
// matrices (equation (2)), whole jump vectors, placements by Lagrange multipliers, and LU.
Eigen::MatrixXd SolveAgain(const PoseLattice& lattice, double levelling) {
  const Eigen::Index num_vertices = lattice.vertices.rows(),
                     num_triangles = lattice.triangles.rows();
  const auto num_poses = static_cast<Eigen::Index>(lattice.pose_vertices.size());
  std::vector<Eigen::Triplet<double>> gradient_entries;
  Eigen::VectorXd area(num_triangles);
  Points centroid(num_triangles, 2);
  for (Eigen::Index t = 0; t < num_triangles; ++t) {
    const Eigen::RowVector3i v = lattice.triangles.row(t);
    Eigen::Matrix2d edges;
    edges << lattice.vertices.row(v[0]) - lattice.vertices.row(v[2]),
        lattice.vertices.row(v[1]) - lattice.vertices.row(v[2]);
    Eigen::Matrix<double, 2, 3> differences;
    differences << 1, 0, -1, 0, 1, -1;
    const Eigen::Matrix<double, 2, 3> jacobian = edges.inverse() * differences;
    for (int d = 0; d < 2; ++d) {
      for (int k = 0; k < 3; ++k) gradient_entries.emplace_back(2 * t + d, v[k], jacobian(d, k));
    }
    area[t] = 0.5 * edges.determinant();
    centroid.row(t) =
        (lattice.vertices.row(v[0]) + lattice.vertices.row(v[1]) + lattice.vertices.row(v[2])) /
        3.0;
  }
  Eigen::SparseMatrix<double> gradient(2 * num_triangles, num_vertices);
  gradient.setFromTriplets(gradient_entries.begin(), gradient_entries.end());

  std::vector<Eigen::Triplet<double>> rows;
  Eigen::Index next = 0;
  const Edges edges = EdgesOf(lattice.triangles);
  for (const auto& edge : edges.rowwise()) {
    if (edge[3] < 0) continue;
    const double length = (lattice.vertices.row(edge[0]) - lattice.vertices.row(edge[1])).norm();
    const double root = std::sqrt(length / (centroid.row(edge[2]) - centroid.row(edge[3])).norm());
    for (int d = 0; d < 2; ++d) {
      rows.emplace_back(next, 2 * edge[2] + d, root);
      rows.emplace_back(next++, 2 * edge[3] + d, -root);
    }
  }
  for (Eigen::Index t = 0; t < num_triangles; ++t) {
    for (int d = 0; d < 2; ++d) {
      rows.emplace_back(next++, 2 * t + d, std::sqrt(1.5 * area[t]) / levelling);
    }
  }
  Eigen::SparseMatrix<double> stacked(next, 2 * num_triangles);
  stacked.setFromTriplets(rows.begin(), rows.end());
  const Eigen::SparseMatrix<double> equations = stacked * gradient;
  const Eigen::SparseMatrix<double> normal = equations.transpose() * equations;

  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < normal.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(normal, column); it; ++it) {
      entries.emplace_back(it.row(), it.col(), it.value());
    }
  }
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(num_vertices + num_poses, num_poses);
  for (Eigen::Index i = 0; i < num_poses; ++i) {
    entries.emplace_back(num_vertices + i, lattice.pose_vertices[i], 1.0);
    entries.emplace_back(lattice.pose_vertices[i], num_vertices + i, 1.0);
    right(num_vertices + i, i) = 1.0;
  }
  Eigen::SparseMatrix<double> system(num_vertices + num_poses, num_vertices + num_poses);
  system.setFromTriplets(entries.begin(), entries.end());
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(system);
  return lu.solve(right).topRows(num_vertices);
}

TEST(PoseWeights, AgreeWithASecondSolveOfTheSameEnergy) {
  // Diameter 1, so that the domain is the placements' box and 0.5 around it.
  const Points placements = PointsOf("0 0, 0.8 0.1, 0.3 0.12, 0.33 0.1, 0.8 0.6, 0 0.6");
  const Point margin(0.5, 0.5);
  ASSERT_NEAR((placements.row(0) - placements.row(4)).norm(), 1.0, 1e-15);
  const PoseLattice lattice =
      TessellateAround(placements.rowwise() + margin.transpose(), Point(1.8, 1.6), 1.0 / 48);
  for (const double levelling : {0.4, 5.0}) {
    const PoseWeights weights = Fitted(placements, {.levelling = levelling});
    const Eigen::MatrixXd expected = SolveAgain(lattice, levelling);
    int compared = 0;
    for (Eigen::Index v = 0; v < lattice.vertices.rows(); ++v) {
      const Point vertex = lattice.vertices.row(v).transpose();
      const double to_rim = vertex.cwiseMin(lattice.size - vertex).minCoeff();
      if (to_rim < 0.2) continue;  // eased
      ++compared;
      const Eigen::VectorXd found = weights.At(vertex - margin);
      ASSERT_LT((found - expected.row(v).transpose()).cwiseAbs().maxCoeff(), 1e-7);
    }
    EXPECT_GT(compared, 3000);
  }
}

TEST(PoseWeights, RefuseCoincidentPlacementsAndNameBoth) {
  const auto weights = PoseWeights::Fit(PointsOf("0 0, 5 5, 10 0, 5 5.009"));
  ASSERT_FALSE(weights);
  EXPECT_EQ(weights.error().code, ErrorCode::kPlacementsCoincide);
  ASSERT_EQ(weights.error().where.size(), 2u);
  EXPECT_EQ(weights.error().where[0].field, "placements[1]");
  EXPECT_EQ(weights.error().where[1].field, "placements[3]");
  EXPECT_TRUE(PoseWeights::Fit(PointsOf("0 0, 5 5, 10 0, 5 5.011")));
  Points denormal = PointsOf("0 0, 1 0");
  denormal(1, 0) = 1e-310;
  for (const Points& placements : {PointsOf("1 1, 1 1"), PointsOf("0 0, 0 0, 0 0"), denormal}) {
    const auto all = PoseWeights::Fit(placements);
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().code, ErrorCode::kPlacementsCoincide);
  }
}

TEST(PoseWeights, RefusePlacementsThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, -infinity}) {
    Points placements = kPlacements;
    placements(3, 1) = bad;
    const auto weights = PoseWeights::Fit(placements);
    ASSERT_FALSE(weights);
    EXPECT_EQ(weights.error().code, ErrorCode::kPlacementNotFinite);
    ASSERT_EQ(weights.error().where.size(), 1u);
    EXPECT_EQ(weights.error().where[0].field, "placements[3]");
  }
  const auto overflow = PoseWeights::Fit(PointsOf("-1.7e308 0, 1.7e308 0"));
  ASSERT_FALSE(overflow);
  EXPECT_EQ(overflow.error().code, ErrorCode::kPlacementNotFinite);
  EXPECT_EQ(PoseWeights::Fit(Points(0, 2)).error().code, ErrorCode::kNoShapes);
}

TEST(PoseWeights, RefuseALevellingLengthOutOfRange) {
  for (const double levelling : {0.0, -1.0, 1e-3, 1e3, std::nan("")}) {
    const auto weights = PoseWeights::Fit(kPlacements, {.levelling = levelling});
    ASSERT_FALSE(weights);
    EXPECT_EQ(weights.error().code, ErrorCode::kInvalidOption);
  }
  for (const double levelling : {1e-2, 1e2}) {
    EXPECT_LT(ErrorAtPlacements(Fitted(kPlacements, {.levelling = levelling}), kPlacements), 1e-12);
  }
}

TEST(PoseWeights, StopWhenCancelledAndReportProgress) {
  Progress cancelled;
  cancelled.Cancel();
  const auto stopped = PoseWeights::Fit(kPlacements, {}, &cancelled);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);

  double last = 0.0;
  Progress progress([&](std::string_view, double fraction) { last = fraction; });
  progress.EnterStage("weights", 0.0, 1.0);
  EXPECT_TRUE(PoseWeights::Fit(kPlacements, {}, &progress));
  EXPECT_EQ(last, 1.0);
}

TEST(PoseWeights, AreTheSameEachTime) {
  const PoseWeights one = Fitted(kPlacements), other = Fitted(kPlacements);
  for (const Point& point : {Point(0.3, 0.4), Point(1.9, 1.1), Point(-7, 2)}) {
    EXPECT_EQ(one.At(point), other.At(point));
  }
}

TEST(PoseWeights, OfAnEarlierFitAreTheSameToTheLastBit) {
  const Points placements = PointsOf("0 0, 1 0.2, 0.4 1, 0.45 1.02");
  const auto fitted = PoseWeights::Fit(placements);
  ASSERT_THAT(fitted, Succeeds());
  const auto again = PoseWeights::FromFit(placements, fitted->fit());
  ASSERT_THAT(again, Succeeds());
  for (int k = 0; k < 200; ++k) {
    const Point at(0.02 * k - 1.0, std::sin(k));
    EXPECT_EQ(again->At(at), fitted->At(at)) << k;
  }
}

TEST(PoseWeights, OfAnEarlierFitOfOnePoseAreOne) {
  const Points one = PointsOf("3 4");
  const auto again = PoseWeights::FromFit(one, PoseWeights::Fit(one)->fit());
  ASSERT_THAT(again, Succeeds());
  EXPECT_EQ(again->At(Point(0, 0)), Eigen::VectorXd::Ones(1));
}

TEST(PoseWeights, RefuseAFitOfOtherPlacements) {
  const auto fit = PoseWeights::Fit(PointsOf("0 0, 1 0, 0 1"))->fit();
  for (const char* others : {"0 0", "0 0, 1 0", "0 0, 3 0, 0 1", "0 0, 1 0, 0 1, 1 1"}) {
    EXPECT_THAT(PoseWeights::FromFit(PointsOf(others), fit), FailsWith(ErrorCode::kSizeMismatch))
        << others;
  }
  EXPECT_THAT(PoseWeights::FromFit(PointsOf("0 0, 0 0"), fit),
              FailsWith(ErrorCode::kPlacementsCoincide));
}

}  // namespace
}  // namespace posespace
