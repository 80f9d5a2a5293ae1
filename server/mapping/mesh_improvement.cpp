// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_improvement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mapping/editable_mesh.h"
#include "mapping/mesh_refinement.h"
#include "mapping/mesh_relaxation.h"
#include "mapping/triangle_quality.h"

namespace posespace {
namespace {

// Rounds of refinement, each followed by relaxation.  The longest edge allowed comes down by
// kDescent a round, so that later rounds split edges of a mesh that is already in shape.
constexpr int kRounds = 10;
constexpr double kDescent = 1.2;
constexpr double kLongest = 1.4;   // targets, in the last two rounds
constexpr double kShortest = 0.5;  // targets
constexpr double kTradable = 5.0;  // degrees: wider angles may be traded for others
constexpr double kSharp = 15.0;    // degrees: vertices at smaller angles are removed for wider ones
constexpr double kRounding = 1e-9;  // of an angle, when the middle of a side is rounded
constexpr int kSweeps = 4;          // of smoothing between flips
constexpr int kFinalRounds = 12;    // of flips and smoothing, at most

double Cotangent(double degrees) { return 1.0 / std::tan(degrees * std::numbers::pi / 180.0); }

// Refines by length.  A triangle that is not as sharp as `tradable` may become so on the way;
// splits make none sharper than `sharpest`.
CompatibleMesh RefineByLength(const CompatibleMesh& mesh, double tradable, double sharpest,
                              const ImprovementOptions& options, Progress* progress) {
  const double sharp = Cotangent(kSharp);
  const std::vector<double> targets = TargetLengths(mesh, options.target_edge_length);
  EditableMesh editable(mesh);
  Relax(editable, 2, kSweeps, tradable, progress);
  for (int round = 0; round < kRounds && !IsCancelled(progress); ++round) {
    const double longest = kLongest * std::pow(kDescent, std::max(0, kRounds - 2 - round));
    SplitLongEdges(editable, targets, longest, sharpest, options.max_vertices, progress);
    Relax(editable, 2, kSweeps, tradable, progress);
    CollapseShortEdges(editable, targets, kShortest, tradable, progress);
    RemoveAtSharpTriangles(editable, sharp, progress);
    Report(progress, (round + 1.0) / (kRounds + 1.0));
  }
  Relax(editable, kFinalRounds, 2, tradable, progress);
  return editable.Finish();
}

// Refines by length without a triangle sharper than the mesh's sharpest at any step.  Where that
// forbids most splits, as in a square of two triangles, it starts again from quarters of the
// triangles, which keep every angle.
CompatibleMesh RefineKeepingAngles(CompatibleMesh mesh, const ImprovementOptions& options,
                                   Progress* progress) {
  const double given = (1.0 - kRounding) * MinAngle(mesh);
  const double sharpest = (1.0 + 0.5 * kRounding) * SharpestOf(mesh);
  const double tradable = std::min(Cotangent(kTradable), sharpest);
  const std::vector<double> targets = TargetLengths(mesh, options.target_edge_length);
  for (;;) {
    CompatibleMesh improved = RefineByLength(mesh, tradable, sharpest, options, progress);
    if (MinAngle(improved) < given) improved = mesh;
    const Eigen::Index finer = mesh.num_vertices() + EdgesOf(mesh.triangles).rows();
    if (IsCancelled(progress) || MeanEdge(EditableMesh(improved), targets) <= kLongest ||
        finer > options.max_vertices || !QuarterTriangles(mesh)) {
      return improved;
    }
  }
}

}  // namespace

Result<CompatibleMesh> ImproveMesh(CompatibleMesh mesh, const ImprovementOptions& options,
                                   Progress* progress) {
  // Free trade between angles makes the best mesh, but may end below a good mesh's smallest angle.
  const double given = (1.0 - kRounding) * MinAngle(mesh);
  const double tradable = Cotangent(kTradable);
  const double sharpest = 2.0 * std::max(tradable, SharpestOf(mesh));
  CompatibleMesh improved = RefineByLength(mesh, tradable, sharpest, options, progress);
  if (MinAngle(improved) < given) {
    improved = RefineKeepingAngles(std::move(mesh), options, progress);
  }
  if (IsCancelled(progress)) {
    return Error{ErrorCode::kCancelled, "mesh improvement was cancelled", {}};
  }
  Report(progress, 1.0);
  return improved;
}

}  // namespace posespace
