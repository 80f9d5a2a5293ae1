// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <limits>
#include <numeric>
#include <vector>

namespace posespace {

double MinAngle(const Point& a, const Point& b, const Point& c) {
  const double area = std::abs(Cross(a, b, c));
  if (!(area > 0.0)) return 0.0;
  const auto angle = [&](const Point& at, const Point& p, const Point& q) {
    return std::atan2(area, (p - at).dot(q - at));
  };
  return std::min({angle(a, b, c), angle(b, c, a), angle(c, a, b)});
}

double MinAngle(const CompatibleMesh& mesh) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Points& pose : mesh.poses) {
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const auto row = mesh.triangles.row(t);
      smallest = std::min(smallest, MinAngle(Point(pose.row(row[0])), Point(pose.row(row[1])),
                                             Point(pose.row(row[2]))));
    }
  }
  return smallest;
}

Edges EdgesOf(const Triangles& triangles) {
  // Sides (a, b) with a < b are put in order by a, counting; then few are left to compare.
  struct Side {
    std::int32_t b, triangle;
    auto operator<=>(const Side&) const = default;
  };
  const auto for_each_side = [&triangles](const auto& visit) {
    for (std::int32_t t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(triangles(t, k), triangles(t, (k + 1) % 3));
        visit(a, Side{b, t});
      }
    }
  };
  const int num_vertices = triangles.size() == 0 ? 0 : triangles.maxCoeff() + 1;
  std::vector<std::size_t> first(num_vertices + 1, 0);
  for_each_side([&](std::int32_t a, const Side&) { ++first[a + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Side> sides(first.back());
  std::vector<std::size_t> next = first;
  for_each_side([&](std::int32_t a, const Side& side) { sides[next[a]++] = side; });

  Edges edges(static_cast<Eigen::Index>(sides.size()), 4);
  Eigen::Index count = 0;
  for (std::int32_t a = 0; a < num_vertices; ++a) {
    std::sort(sides.begin() + first[a], sides.begin() + first[a + 1]);
    for (std::size_t i = first[a]; i < first[a + 1]; ++i) {
      const bool shared = i + 1 < first[a + 1] && sides[i].b == sides[i + 1].b;
      edges.row(count++) << a, sides[i].b, sides[i].triangle, shared ? sides[i + 1].triangle : -1;
      if (shared) ++i;
    }
  }
  edges.conservativeResize(count, Eigen::NoChange);
  return edges;
}

}  // namespace posespace
