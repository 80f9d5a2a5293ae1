// SPDX-License-Identifier: Apache-2.0
#include "drawing/interior_moves.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr double kSharp = 8.0 * std::numbers::pi / 180.0;

double AngleOf(const Triangles& triangles, const Points& pose, int t) {
  return MinAngle(Point(pose.row(triangles(t, 0))), Point(pose.row(triangles(t, 1))),
                  Point(pose.row(triangles(t, 2))));
}

// Two sides of a triangle, in columns.
Eigen::Matrix2d SidesOf(const Triangles& triangles, const Points& pose, int t) {
  const Point a = pose.row(triangles(t, 0)).transpose();
  Eigen::Matrix2d sides;
  sides << pose.row(triangles(t, 1)).transpose() - a, pose.row(triangles(t, 2)).transpose() - a;
  return sides;
}

// The largest singular value of a map that does not mirror, or one over the smallest.
double StretchOf(const Eigen::Matrix2d& map) {
  const double squares = map.squaredNorm(), area = map.determinant();
  const double sum = std::sqrt(squares + 2.0 * area);
  const double difference = std::sqrt(std::max(squares - 2.0 * area, 0.0));
  return std::max(0.5 * (sum + difference), 0.5 * (sum + difference) / area);
}

}  // namespace

InteriorMoves::InteriorMoves(const CompatibleMesh& mesh, const Points& pose)
    : triangles_(&mesh.triangles),
      pose_(pose),
      free_(mesh.num_vertices(), 1),
      around_(mesh.num_vertices()),
      least_(mesh.num_triangles(), 0.0),
      inverse_(mesh.num_triangles()) {
  for (const std::vector<int>& loop : mesh.boundary) {
    for (const int v : loop) free_[v] = 0;
  }
  for (const int v : mesh.landmarks) free_[v] = 0;

  // A star's bound binds each of its triangles, and each triangle lies in three stars.
  std::vector<double> star(mesh.num_vertices(), kSharp);
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const double angle = AngleOf(mesh.triangles, pose, t);
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.triangles(t, k);
      around_[v].push_back(t);
      star[v] = std::min(star[v], angle);
    }
  }
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) least_[t] = std::max(least_[t], star[mesh.triangles(t, k)]);
    inverse_[t] = SidesOf(mesh.triangles, pose, t).inverse();
  }
}

bool InteriorMoves::Move(int vertex, const Point& to) {
  const Point from = pose_.row(vertex).transpose();
  pose_.row(vertex) = to.transpose();
  if (IsAllowed(vertex)) return true;
  pose_.row(vertex) = from.transpose();
  return false;
}

bool InteriorMoves::IsAllowed(int vertex) const {
  const Triangles& triangles = *triangles_;
  return std::all_of(around_[vertex].begin(), around_[vertex].end(), [&](int t) {
    return Orientation(pose_.row(triangles(t, 0)).transpose(),
                       pose_.row(triangles(t, 1)).transpose(),
                       pose_.row(triangles(t, 2)).transpose()) > 0 &&
           AngleOf(triangles, pose_, t) >= least_[t] &&
           StretchOf(SidesOf(triangles, pose_, t) * inverse_[t]) <= kMostStretch;
  });
}

}  // namespace posespace
