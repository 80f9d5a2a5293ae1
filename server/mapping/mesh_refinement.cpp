// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "geometry/polygon.h"
#include "mapping/decimation.h"

namespace posespace {
namespace {

constexpr double kLongest = 1.4;   // targets
constexpr double kShortest = 0.5;  // targets

// Length of an edge in targets, in the pose where it is longest.
double RelativeLength(const EditableMesh& mesh, std::span<const double> targets, int a, int b) {
  double longest = 0.0;
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    const double length = (mesh.At(pose, b) - mesh.At(pose, a)).norm();
    longest = std::max(longest, length / targets[pose]);
  }
  return longest;
}

// The middle of ab, where rounding must not push it out of the drawing (to the negative side of
// the boundary edge a -> b): a vertex outside could meet another part of the outline.
Point BoundaryMiddle(const Point& a, const Point& b) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Point middle = 0.5 * (a + b);
  if (Orientation(a, b, middle) >= 0) return middle;
  const Point inward(a.y() - b.y(), b.x() - a.x());
  Point nudged = middle;
  nudged.x() = std::nextafter(middle.x(), inward.x() > 0.0 ? infinity : -infinity);
  if (Orientation(a, b, nudged) >= 0) return nudged;
  nudged = middle;
  nudged.y() = std::nextafter(middle.y(), inward.y() > 0.0 ? infinity : -infinity);
  return nudged;
}

// Splits ab in the middle where that leaves all triangles positive; the new vertex, or nothing.
std::optional<int> SplitEdge(EditableMesh& mesh, int a, int b) {
  const int c = mesh.Opposite(a, b), d = mesh.Opposite(b, a);
  std::vector<Point> middles;
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    const Point &pa = mesh.At(pose, a), &pb = mesh.At(pose, b);
    const Point middle = d < 0   ? BoundaryMiddle(pa, pb)
                         : c < 0 ? BoundaryMiddle(pb, pa)
                                 : Point(0.5 * (pa + pb));
    if (d < 0 && Orientation(pa, pb, middle) < 0) return std::nullopt;
    if (c < 0 && Orientation(pb, pa, middle) < 0) return std::nullopt;
    for (const auto& [from, to, apex] : {std::tuple(pa, pb, c), std::tuple(pb, pa, d)}) {
      if (apex < 0) continue;
      const Point& tip = mesh.At(pose, apex);
      if (Orientation(from, middle, tip) <= 0 || Orientation(middle, to, tip) <= 0) {
        return std::nullopt;
      }
    }
    middles.push_back(middle);
  }
  return mesh.Split(a, b, middles);
}

}  // namespace

std::vector<double> TargetLengths(const CompatibleMesh& mesh, double relative) {
  std::vector<double> targets;
  for (const Points& pose : mesh.poses) {
    double area = 0.0;
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const auto corners = mesh.triangles.row(t);
      area += 0.5 * Cross(pose.row(corners[0]), pose.row(corners[1]), pose.row(corners[2]));
    }
    targets.push_back(relative * std::sqrt(area));
  }
  return targets;
}

int SplitLongEdges(EditableMesh& mesh, std::span<const double> targets, int max_vertices,
                   Progress* progress) {
  // Longest first; of equals, the one with smaller vertices.
  using Entry = std::tuple<double, int, int>;
  std::priority_queue<Entry> open;
  const auto push = [&](int a, int b) {
    const double length = RelativeLength(mesh, targets, a, b);
    if (length > kLongest) open.emplace(length, -std::min(a, b), -std::max(a, b));
  };
  for (const auto& [a, b] : mesh.AllEdges()) push(a, b);

  int splits = 0;
  while (!open.empty() && mesh.num_live_vertices() < max_vertices && !IsCancelled(progress)) {
    const int a = -std::get<1>(open.top()), b = -std::get<2>(open.top());
    open.pop();
    if (!mesh.HasEdge(a, b)) continue;
    const auto middle = SplitEdge(mesh, a, b);
    if (!middle) continue;
    ++splits;
    for (const int t : mesh.TrianglesAt(*middle)) {
      for (const int corner : mesh.At(t)) {
        if (corner != *middle) push(*middle, corner);
      }
    }
  }
  return splits;
}

int CollapseShortEdges(EditableMesh& mesh, std::span<const double> targets, double sharpest,
                       Progress* progress) {
  int removed = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (IsCancelled(progress)) break;
    if (!mesh.IsLive(v) || mesh.IsFixed(v)) continue;
    const std::vector<int> link = mesh.Link(v);
    const bool crowded = std::any_of(link.begin(), link.end(), [&](int neighbour) {
      return RelativeLength(mesh, targets, v, neighbour) < kShortest;
    });
    if (crowded && RemoveVertex(mesh, v, sharpest)) ++removed;
  }
  return removed;
}

}  // namespace posespace
