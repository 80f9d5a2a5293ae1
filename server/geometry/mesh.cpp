// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
  std::vector<std::array<std::int32_t, 3>> sides;  // (a, b, triangle) with a < b
  sides.reserve(static_cast<std::size_t>(triangles.rows()) * 3);
  for (std::int32_t t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangles(t, k), triangles(t, (k + 1) % 3));
      sides.push_back({a, b, t});
    }
  }
  std::sort(sides.begin(), sides.end());
  Edges edges(static_cast<Eigen::Index>(sides.size()), 4);
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool shared =
        i + 1 < sides.size() && sides[i][0] == sides[i + 1][0] && sides[i][1] == sides[i + 1][1];
    edges.row(count++) << sides[i][0], sides[i][1], sides[i][2], shared ? sides[i + 1][2] : -1;
    if (shared) ++i;
  }
  edges.conservativeResize(count, Eigen::NoChange);
  return edges;
}

}  // namespace posespace
