// SPDX-License-Identifier: Apache-2.0
#include "mapping/vertex_removal.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/triangle_quality.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

// The part of a polygon to the positive side of the line from a to b.
std::vector<Point> Clip(const std::vector<Point>& polygon, const Point& a, const Point& b) {
  std::vector<Point> kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double p_side = Cross(a, b, p), q_side = Cross(a, b, q);
    if (p_side > 0.0) kept.push_back(p);
    if ((p_side > 0.0) != (q_side > 0.0)) kept.push_back(p + p_side / (p_side - q_side) * (q - p));
  }
  return kept;
}

// A point that sees the whole ring from inside, in the middle of all such points; nothing when
// there is none.  Not exact: the caller tests it.
std::optional<Point> PointInKernel(const std::vector<Point>& ring) {
  std::vector<Point> kernel = ring;
  for (std::size_t k = 0; k < ring.size() && !kernel.empty(); ++k) {
    kernel = Clip(kernel, ring[k], ring[(k + 1) % ring.size()]);
  }
  if (kernel.empty()) return std::nullopt;
  Point sum = Point::Zero();
  for (const Point& p : kernel) sum += p;
  return sum / static_cast<double>(kernel.size());
}

}  // namespace

double SharpnessAround(const EditableMesh& mesh, int vertex) {
  double sharpest = 0.0;
  for (const int t : mesh.TrianglesAt(vertex)) {
    const auto [a, b, c] = mesh.At(t);
    for (int pose = 0; pose < mesh.num_poses(); ++pose) {
      sharpest =
          std::max(sharpest, Sharpness(mesh.At(pose, a), mesh.At(pose, b), mesh.At(pose, c)));
    }
  }
  return sharpest;
}

bool RemoveVertex(EditableMesh& mesh, int vertex, double sharpest) {
  const std::vector<int> link = mesh.Link(vertex);
  const int n = static_cast<int>(link.size());
  std::vector<std::pair<int, int>> taken;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 2; j < n; ++j) {
      if ((i > 0 || j < n - 1) && mesh.HasEdge(link[i], link[j])) taken.emplace_back(i, j);
    }
  }
  std::vector<Points> rings(mesh.num_poses(), Points(n, 2));
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    for (int k = 0; k < n; ++k) rings[pose].row(k) = mesh.At(pose, link[k]).transpose();
  }
  auto triangles = TriangulateRings(rings, taken);
  if (!triangles) return false;
  for (Triangle& corners : *triangles) {
    for (int& corner : corners) corner = link[corner];
    for (int pose = 0; pose < mesh.num_poses(); ++pose) {
      const double sharpness = Sharpness(mesh.At(pose, corners[0]), mesh.At(pose, corners[1]),
                                         mesh.At(pose, corners[2]));
      if (sharpness > sharpest) return false;
    }
  }
  const std::vector<int> star(mesh.TrianglesAt(vertex).begin(), mesh.TrianglesAt(vertex).end());
  mesh.Refill(star, *triangles);
  return true;
}

bool MergeVertices(EditableMesh& mesh, int u, int v, double sharpest) {
  const int left = mesh.Opposite(u, v), right = mesh.Opposite(v, u);
  std::vector<int> ring;  // around the triangles of both
  for (int at = left; at != right; at = mesh.Opposite(u, at)) ring.push_back(at);
  for (int at = right; at != left; at = mesh.Opposite(v, at)) ring.push_back(at);
  std::vector<int> sorted = ring;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return false;

  std::vector<Point> places;
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    std::vector<Point> corners;
    for (const int w : ring) corners.push_back(mesh.At(pose, w));
    const auto place = PointInKernel(corners);
    if (!place) return false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point &a = corners[k], &b = corners[(k + 1) % corners.size()];
      if (Orientation(a, b, *place) <= 0 || Sharpness(a, b, *place) > sharpest) return false;
    }
    places.push_back(*place);
  }
  std::vector<int> patch(mesh.TrianglesAt(u).begin(), mesh.TrianglesAt(u).end());
  for (const int t : mesh.TrianglesAt(v)) {
    if (std::find(patch.begin(), patch.end(), t) == patch.end()) patch.push_back(t);
  }
  std::vector<Triangle> fan;
  for (std::size_t k = 0; k < ring.size(); ++k)
    fan.push_back({u, ring[k], ring[(k + 1) % ring.size()]});
  for (int pose = 0; pose < mesh.num_poses(); ++pose) mesh.Move(pose, u, places[pose]);
  mesh.Refill(patch, fan);
  return true;
}

}  // namespace posespace
