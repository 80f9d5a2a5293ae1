// SPDX-License-Identifier: Apache-2.0
#include "mapping/decimation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "mapping/mesh_relaxation.h"
#include "mapping/triangle_quality.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

// One pass over the interior vertices, those with few neighbours first: they are the easiest.
int RemoveVertices(EditableMesh& mesh, Progress* progress) {
  std::vector<std::pair<std::size_t, int>> order;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (mesh.IsLive(v) && !mesh.IsFixed(v)) order.emplace_back(mesh.TrianglesAt(v).size(), v);
  }
  std::sort(order.begin(), order.end());
  int removed = 0;
  for (const auto& [degree, v] : order) {
    if (IsCancelled(progress)) break;
    removed += RemoveVertex(mesh, v, kAnySharpness) ? 1 : 0;
  }
  return removed;
}

}  // namespace

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
  mesh.Remove(vertex, *triangles);
  return true;
}

void Decimate(EditableMesh& mesh, Progress* progress) {
  constexpr int kPatience = 3;  // rounds of smoothing and flips without a vertex removed
  constexpr int kSweeps = 3;
  for (int idle = 0; idle < kPatience && !IsCancelled(progress);) {
    int removed = 0;
    while (const int more = RemoveVertices(mesh, progress)) removed += more;
    idle = removed > 0 ? 0 : idle + 1;
    Relax(mesh, 1, kSweeps, kAnySharpness, progress);
  }
}

}  // namespace posespace
