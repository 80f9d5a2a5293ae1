// SPDX-License-Identifier: Apache-2.0
#include "geometry/polygon.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace posespace {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 ToCgal(const Point& p) { return {p.x(), p.y()}; }

Point Row(const Points& ring, int k) { return ring.row(k).transpose(); }

// True when edges i and j of the ring meet in more than the point they are allowed to share.
bool EdgesClash(const Points& ring, int i, int j) {
  const int n = static_cast<int>(ring.rows());
  const Point a = Row(ring, i), b = Row(ring, (i + 1) % n);
  const Point c = Row(ring, j), d = Row(ring, (j + 1) % n);
  if ((i + 1) % n == j) return IsOnSegment(d, a, b) || IsOnSegment(a, c, d);
  if ((j + 1) % n == i) return IsOnSegment(b, c, d) || IsOnSegment(c, a, b);
  return SegmentsMeet(a, b, c, d);
}

}  // namespace

int Orientation(const Point& a, const Point& b, const Point& c) {
  return static_cast<int>(CGAL::orientation(ToCgal(a), ToCgal(b), ToCgal(c)));
}

bool IsOnSegment(const Point& p, const Point& a, const Point& b) {
  if (Orientation(a, b, p) != 0) return false;
  const auto [low_x, high_x] = std::minmax(a.x(), b.x());
  const auto [low_y, high_y] = std::minmax(a.y(), b.y());
  return low_x <= p.x() && p.x() <= high_x && low_y <= p.y() && p.y() <= high_y;
}

bool SegmentsMeet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const int c_side = Orientation(a, b, c), d_side = Orientation(a, b, d);
  const int a_side = Orientation(c, d, a), b_side = Orientation(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && IsOnSegment(c, a, b)) || (d_side == 0 && IsOnSegment(d, a, b)) ||
         (a_side == 0 && IsOnSegment(a, c, d)) || (b_side == 0 && IsOnSegment(b, c, d));
}

double SignedArea(const Points& ring) {
  const auto n = ring.rows();
  if (n < 3) return 0.0;
  const Point origin = Row(ring, 0);  // keeps digits when the drawing is far from (0, 0)
  double twice = 0.0;
  for (int k = 1; k + 1 < n; ++k) twice += Cross(origin, Row(ring, k), Row(ring, k + 1));
  return 0.5 * twice;
}

Point AreaCentroid(const Points& ring) {
  const Point origin = Row(ring, 0);
  double twice = 0.0;
  Point moment = Point::Zero();
  for (int k = 1; k + 1 < ring.rows(); ++k) {
    const Point p = Row(ring, k) - origin, q = Row(ring, k + 1) - origin;
    const double cross = p.x() * q.y() - p.y() * q.x();
    twice += cross;
    moment += cross * (p + q);
  }
  return origin + moment / (3.0 * twice);
}

double Perimeter(const Points& ring) {
  double length = 0.0;
  for (int k = 0; k < ring.rows(); ++k) {
    length += (ring.row((k + 1) % ring.rows()) - ring.row(k)).norm();
  }
  return length;
}

std::optional<std::pair<int, int>> FindCrossing(const Points& ring, const Progress* progress) {
  const int n = static_cast<int>(ring.rows());
  if (n < 3) return std::pair{0, std::max(0, n - 1)};
  const auto low = [&](int k, int axis) {
    return std::min(ring(k, axis), ring((k + 1) % n, axis));
  };
  const auto high = [&](int k, int axis) {
    return std::max(ring(k, axis), ring((k + 1) % n, axis));
  };

  // Sweep over edges by their left end: only edges that overlap in x are tested.
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return std::pair(low(i, 0), i) < std::pair(low(j, 0), j); });
  std::optional<std::pair<int, int>> first;
  std::vector<int> active;
  for (const int edge : order) {
    if (IsCancelled(progress)) return std::nullopt;
    std::erase_if(active, [&](int other) { return high(other, 0) < low(edge, 0); });
    for (const int other : active) {
      if (high(other, 1) < low(edge, 1) || high(edge, 1) < low(other, 1)) continue;
      const std::pair<int, int> pair = std::minmax(edge, other);
      if (first && *first <= pair) continue;
      if (EdgesClash(ring, pair.first, pair.second)) first = pair;
    }
    active.push_back(edge);
  }
  return first;
}

int Locate(const Point& p, const Points& ring) {
  const int n = static_cast<int>(ring.rows());
  bool inside = false;
  for (int k = 0; k < n; ++k) {
    const Point a = Row(ring, k), b = Row(ring, (k + 1) % n);
    if (IsOnSegment(p, a, b)) return 0;
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const bool upward = b.y() > a.y();
    if (Orientation(a, b, p) == (upward ? 1 : -1)) inside = !inside;
  }
  return inside ? 1 : -1;
}

std::optional<MeshDefect> FindDefect(const CompatibleMesh& mesh) {
  for (int i = 0; i < mesh.num_poses(); ++i) {
    const Points& pose = mesh.poses[i];
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const auto row = mesh.triangles.row(t);
      if (Orientation(Row(pose, row[0]), Row(pose, row[1]), Row(pose, row[2])) <= 0) {
        return MeshDefect{i, t, -1, -1};
      }
    }
    for (const std::vector<int>& loop : mesh.boundary) {
      Points ring(static_cast<Eigen::Index>(loop.size()), 2);
      for (std::size_t k = 0; k < loop.size(); ++k) ring.row(k) = pose.row(loop[k]);
      if (const auto crossing = FindCrossing(ring)) {
        return MeshDefect{i, -1, crossing->first, crossing->second};
      }
    }
  }
  return std::nullopt;
}

}  // namespace posespace
