// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_improvement.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/decimation.h"
#include "mapping/editable_mesh.h"
#include "mapping/mesh_relaxation.h"
#include "mapping/mesh_refinement.h"
#include "mapping/triangle_quality.h"

namespace posespace {
namespace {

constexpr int kRounds = 4;        // of refinement, each followed by relaxation
constexpr int kSweeps = 4;        // of smoothing in a round
constexpr int kFinalRounds = 12;  // of flips and smoothing at the end, at most

void Relax(EditableMesh& mesh, int rounds, int sweeps, double sharpest, Progress* progress) {
  for (int round = 0; round < rounds && !IsCancelled(progress); ++round) {
    int changes = FlipEdges(mesh, {sharpest}, progress);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      changes += SmoothVertices(mesh, {sharpest}, progress);
    }
    if (changes == 0) break;
  }
}

}  // namespace

Result<CompatibleMesh> ImproveMesh(CompatibleMesh mesh, const ImprovementOptions& options,
                                   Progress* progress) {
  const double given = MinAngle(mesh);
  const std::vector<double> targets = TargetLengths(mesh, options.target_edge_length);
  EditableMesh editable(mesh);
  const double comfortable = 1.0 / std::tan(std::numbers::pi / 9.0);

  Relax(editable, 2, kSweeps, comfortable, progress);
  for (int round = 0; round < kRounds; ++round) {
    SplitLongEdges(editable, targets, options.max_vertices, progress);
    Relax(editable, 2, kSweeps, comfortable, progress);
    CollapseShortEdges(editable, targets, comfortable, progress);
    Report(progress, (round + 1.0) / (kRounds + 2.0));
  }
  Relax(editable, kFinalRounds, 2, comfortable, progress);
  if (IsCancelled(progress)) {
    return Error{ErrorCode::kCancelled, "mesh improvement was cancelled", {}};
  }
  CompatibleMesh improved = editable.Finish();
  if (MinAngle(improved) >= given && !FindDefect(improved)) return improved;
  return mesh;
}

}  // namespace posespace
