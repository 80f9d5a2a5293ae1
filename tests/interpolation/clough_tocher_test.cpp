// SPDX-License-Identifier: Apache-2.0
#include "interpolation/clough_tocher.h"

#include <gtest/gtest.h>

#include <functional>

namespace posespace {
namespace {

// A value and gradient (f, f_x, f_y) at a vertex.
using Jet = std::function<Eigen::Vector3d(const Point&)>;

const std::array<Point, 3> kTriangle{Point(0.1, 0.2), Point(1.3, -0.1), Point(0.4, 0.9)};

Eigen::Vector3d Barycentric(const std::array<Point, 3>& t, const Point& p) {
  const double area = Cross(t[0], t[1], t[2]);
  return Eigen::Vector3d(Cross(t[1], t[2], p), Cross(t[2], t[0], p), Cross(t[0], t[1], p)) / area;
}

double ValueAt(const std::array<Point, 3>& t, const Jet& jet, const Point& p) {
  const CornerShares shares = CloughTocher(t, Barycentric(t, p));
  double value = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (int d = 0; d < 3; ++d) value += shares[k][d] * jet(t[k])[d];
  }
  return value;
}

Point GradientAt(const std::array<Point, 3>& t, const Jet& jet, const Point& p) {
  constexpr double kStep = 1e-6;
  const Point dx(kStep, 0), dy(0, kStep);
  return Point(ValueAt(t, jet, p + dx) - ValueAt(t, jet, p - dx),
               ValueAt(t, jet, p + dy) - ValueAt(t, jet, p - dy)) /
         (2.0 * kStep);
}

// Some smooth function that no cubic is.
Eigen::Vector3d Wave(const Point& p) {
  return {std::sin(2.0 * p.x() + p.y()), 2.0 * std::cos(2.0 * p.x() + p.y()),
          std::cos(2.0 * p.x() + p.y())};
}

TEST(CloughTocher, SharesOfValuesSumToOne) {
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0.2, 0.3, 0.5), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, 0.4, 0.0),
        Eigen::Vector3d(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)}) {
    const CornerShares shares = CloughTocher(kTriangle, at);
    EXPECT_NEAR(shares[0][0] + shares[1][0] + shares[2][0], 1.0, 1e-15);
  }
}

TEST(CloughTocher, ReproducesLinearFunctions) {
  const Jet linear = [](const Point& p) -> Eigen::Vector3d {
    return {3.0 + 2.0 * p.x() - 5.0 * p.y(), 2.0, -5.0};
  };
  for (const Point& p : {Point(0.5, 0.3), Point(0.7, 0.2), Point(0.3, 0.4)}) {
    EXPECT_NEAR(ValueAt(kTriangle, linear, p), linear(p)[0], 1e-14);
  }
}

TEST(CloughTocher, TakesValuesAndGradientsAtTheCorners) {
  for (const Point& corner : kTriangle) {
    EXPECT_NEAR(ValueAt(kTriangle, Wave, corner), Wave(corner)[0], 1e-15);
    const Point inward = corner + 1e-7 * (Point(0.6, 0.33) - corner);
    EXPECT_LT((GradientAt(kTriangle, Wave, inward) - Wave(corner).tail<2>()).norm(), 1e-4);
  }
}

TEST(CloughTocher, IsSmoothAcrossItsSplits) {
  const Point centroid = (kTriangle[0] + kTriangle[1] + kTriangle[2]) / 3.0;
  for (const Point& corner : kTriangle) {
    for (const double share : {0.0, 0.2, 0.5, 0.8}) {
      const Point p = centroid + share * (corner - centroid);
      const Point across = Point(-(corner - centroid).y(), (corner - centroid).x());
      const Point one = GradientAt(kTriangle, Wave, p + 1e-5 * across);
      const Point other = GradientAt(kTriangle, Wave, p - 1e-5 * across);
      EXPECT_LT((one - other).norm(), 1e-3);
    }
  }
}

TEST(CloughTocher, IsSmoothAcrossAnEdge) {
  const std::array<Point, 3> neighbour{kTriangle[1], kTriangle[0], Point(0.3, -1.2)};
  const Point along = kTriangle[1] - kTriangle[0];
  const Point normal = Point(-along.y(), along.x());
  for (const double share : {0.1, 0.37, 0.5, 0.9}) {
    const Point p = kTriangle[0] + share * along;
    EXPECT_NEAR(ValueAt(kTriangle, Wave, p), ValueAt(neighbour, Wave, p), 1e-14);
    const Point above = GradientAt(kTriangle, Wave, p + 1e-5 * normal);
    const Point below = GradientAt(neighbour, Wave, p - 1e-5 * normal);
    EXPECT_LT((above - below).norm(), 1e-3);
  }
}

TEST(CloughTocher, HasALinearNormalDerivativeAlongEachEdge) {
  for (int k = 0; k < 3; ++k) {
    const Point a = kTriangle[k], b = kTriangle[(k + 1) % 3];
    const Point normal = Point(-(b - a).y(), (b - a).x()).normalized();
    const auto slope = [&](double share) {
      return GradientAt(kTriangle, Wave, a + share * (b - a) + 1e-5 * normal).dot(normal);
    };
    EXPECT_NEAR(slope(0.5), 0.5 * (slope(0.1) + slope(0.9)), 1e-3);
    EXPECT_NEAR(slope(0.3), 0.75 * slope(0.1) + 0.25 * slope(0.9), 1e-3);
  }
}

TEST(CloughTocher, DoesNotDependOnWhichCornerComesFirst) {
  const std::array<Point, 3> turned{kTriangle[1], kTriangle[2], kTriangle[0]};
  for (const Point& p : {Point(0.5, 0.3), Point(0.7, 0.2), Point(0.3, 0.4)}) {
    EXPECT_NEAR(ValueAt(kTriangle, Wave, p), ValueAt(turned, Wave, p), 1e-15);
  }
}

}  // namespace
}  // namespace posespace
