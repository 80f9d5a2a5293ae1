// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "geometry/polygon.h"
#include "mapping/triangle_quality.h"
#include "mapping/vertex_removal.h"

namespace posespace {
namespace {

double Length(const EditableMesh& mesh, std::span<const double> targets, int a, int b) {
  double longest = 0.0;
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    const double length = (mesh.At(pose, b) - mesh.At(pose, a)).norm();
    longest = std::max(longest, length / targets[pose]);
  }
  return longest;
}

// The middle of the boundary edge a -> b.  Where rounding would push it out of the drawing, to the
// negative side, it is moved in by one step of a double: a vertex outside could meet another part
// of the outline.
Point BoundaryMiddle(const Point& a, const Point& b) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Point middle = 0.5 * (a + b);
  const Point inward(a.y() - b.y(), b.x() - a.x());
  const Point far(std::copysign(infinity, inward.x()), std::copysign(infinity, inward.y()));
  const Point in_x(std::nextafter(middle.x(), far.x()), middle.y());
  const Point in_y(middle.x(), std::nextafter(middle.y(), far.y()));
  for (const Point& candidate : {middle, in_x, in_y}) {
    if (Orientation(a, b, candidate) >= 0) return candidate;
  }
  return Point(in_x.x(), in_y.y());
}

Point Middle(const EditableMesh& mesh, int pose, int a, int b) {
  const Point &pa = mesh.At(pose, a), &pb = mesh.At(pose, b);
  if (mesh.Opposite(b, a) < 0) return BoundaryMiddle(pa, pb);
  if (mesh.Opposite(a, b) < 0) return BoundaryMiddle(pb, pa);
  return 0.5 * (pa + pb);
}

// Splits ab in the middle; the new vertex, or nothing where a triangle would not be positive or too
// sharp.
std::optional<int> SplitEdge(EditableMesh& mesh, int a, int b, double sharpest) {
  std::vector<Point> middles;
  const int left = mesh.Opposite(a, b), right = mesh.Opposite(b, a);
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    const Point& middle = middles.emplace_back(Middle(mesh, pose, a, b));
    for (const auto& [from, to, apex] : {std::array{a, b, left}, std::array{b, a, right}}) {
      if (apex < 0) continue;
      const Point &start = mesh.At(pose, from), &end = mesh.At(pose, to);
      const Point& tip = mesh.At(pose, apex);
      if (Orientation(start, middle, tip) <= 0 || Orientation(middle, end, tip) <= 0) return {};
      if (Sharpness(start, middle, tip) > sharpest || Sharpness(middle, end, tip) > sharpest) {
        return {};
      }
    }
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

double MeanEdge(const EditableMesh& mesh, std::span<const double> targets) {
  const auto edges = mesh.AllEdges();
  double sum = 0.0;
  for (const auto& [a, b] : edges) sum += Length(mesh, targets, a, b);
  return sum / static_cast<double>(edges.size());
}

void SplitLongEdges(EditableMesh& mesh, std::span<const double> targets, double longest,
                    double sharpest, int max_vertices, Progress* progress) {
  using Entry = std::tuple<double, int, int>;
  std::priority_queue<Entry> open;
  const auto push = [&](int a, int b) {
    const double length = Length(mesh, targets, a, b);
    if (length > longest) open.emplace(length, a, b);
  };
  for (const auto& [a, b] : mesh.AllEdges()) push(a, b);

  while (!open.empty() && mesh.num_live_vertices() < max_vertices && !IsCancelled(progress)) {
    const auto [length, a, b] = open.top();
    open.pop();
    if (!mesh.HasEdge(a, b)) continue;
    const auto middle = SplitEdge(mesh, a, b, sharpest);
    if (!middle) continue;
    push(a, *middle);
    push(b, *middle);
    for (const auto& [from, to] : {std::pair(a, *middle), std::pair(*middle, a)}) {
      if (const int apex = mesh.Opposite(from, to); apex >= 0) push(*middle, apex);
    }
  }
}

void CollapseShortEdges(EditableMesh& mesh, std::span<const double> targets, double shortest,
                        double sharpest, Progress* progress) {
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (IsCancelled(progress)) return;
    if (!mesh.IsLive(v) || mesh.IsFixed(v)) continue;
    const std::vector<int> link = mesh.Link(v);
    const bool crowded = std::any_of(link.begin(), link.end(), [&](int neighbour) {
      return Length(mesh, targets, v, neighbour) < shortest;
    });
    if (crowded) RemoveVertex(mesh, v, sharpest);
  }
}

void RemoveAtSharpTriangles(EditableMesh& mesh, double sharpest, Progress* progress) {
  constexpr double kLeastGain = 0.97;
  std::vector<std::pair<double, int>> order;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (!mesh.IsLive(v) || mesh.IsFixed(v)) continue;
    const double sharpness = SharpnessAround(mesh, v);
    if (sharpness > sharpest) order.emplace_back(-sharpness, v);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [rank, v] : order) {
    if (IsCancelled(progress)) return;
    const double sharpness = SharpnessAround(mesh, v);
    if (sharpness > sharpest) RemoveVertex(mesh, v, kLeastGain * sharpness);
  }
}

bool QuarterTriangles(CompatibleMesh& mesh) {
  const EditableMesh whole(mesh);
  CompatibleMesh fine = mesh;
  const Edges edges = EdgesOf(mesh.triangles);
  const int old_vertices = mesh.num_vertices();
  std::map<std::pair<int, int>, int> middles;
  for (int e = 0; e < edges.rows(); ++e) {
    middles[{edges(e, 0), edges(e, 1)}] = old_vertices + e;
  }
  const auto middle_of = [&](int a, int b) { return middles.at(std::minmax(a, b)); };
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    fine.poses[pose].conservativeResize(old_vertices + edges.rows(), Eigen::NoChange);
    for (Eigen::Index e = 0; e < edges.rows(); ++e) {
      fine.poses[pose].row(old_vertices + e) =
          Middle(whole, pose, edges(e, 0), edges(e, 1)).transpose();
    }
  }
  fine.triangles.resize(4 * mesh.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    const int a = mesh.triangles(t, 0), b = mesh.triangles(t, 1), c = mesh.triangles(t, 2);
    const int ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
    fine.triangles.middleRows<4>(4 * t) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
  }
  for (std::vector<int>& loop : fine.boundary) {
    std::vector<int> finer;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      finer.push_back(loop[k]);
      finer.push_back(middle_of(loop[k], loop[(k + 1) % loop.size()]));
    }
    loop = std::move(finer);
  }
  if (FindDefect(fine)) return false;
  mesh = std::move(fine);
  return true;
}

}  // namespace posespace
