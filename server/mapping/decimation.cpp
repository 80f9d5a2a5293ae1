// SPDX-License-Identifier: Apache-2.0
#include "mapping/decimation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "mapping/mesh_relaxation.h"
#include "mapping/triangle_quality.h"
#include "mapping/vertex_removal.h"

namespace posespace {
namespace {

constexpr int kPatience = 3;  // rounds of flips and smoothing after which nothing could go
constexpr int kSweeps = 3;

bool MayGo(const EditableMesh& mesh, int vertex) {
  return mesh.IsLive(vertex) && !mesh.IsFixed(vertex);
}

// One pass over the interior vertices, those with few neighbours first: they are the easiest.
int RemoveVertices(EditableMesh& mesh, Progress* progress) {
  std::vector<std::pair<std::size_t, int>> order;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (MayGo(mesh, v)) order.emplace_back(mesh.TrianglesAt(v).size(), v);
  }
  std::sort(order.begin(), order.end());
  int removed = 0;
  for (const auto& [degree, v] : order) {
    if (IsCancelled(progress)) break;
    const double sharpest = std::max(kSliverSharpness, SharpnessAround(mesh, v));
    removed += RemoveVertex(mesh, v, sharpest) ? 1 : 0;
  }
  return removed;
}

int MergeNeighbours(EditableMesh& mesh, Progress* progress) {
  int merged = 0;
  for (const auto& [u, v] : mesh.InteriorEdges()) {
    if (IsCancelled(progress)) break;
    if (!MayGo(mesh, u) || !MayGo(mesh, v) || !mesh.HasEdge(u, v)) continue;
    const double sharpest =
        std::max({kSliverSharpness, SharpnessAround(mesh, u), SharpnessAround(mesh, v)});
    merged += MergeVertices(mesh, u, v, sharpest) ? 1 : 0;
  }
  return merged;
}

}  // namespace

void Decimate(EditableMesh& mesh, Progress* progress) {
  for (int idle = 0; idle < kPatience && !IsCancelled(progress);) {
    int gone = 0;
    while (const int more = RemoveVertices(mesh, progress)) gone += more;
    gone += MergeNeighbours(mesh, progress);
    idle = gone > 0 ? 0 : idle + 1;
    Relax(mesh, 1, kSweeps, kAnySharpness, progress);
  }
}

}  // namespace posespace
