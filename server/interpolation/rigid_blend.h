// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_RIGID_BLEND_H_
#define POSESPACE_INTERPOLATION_RIGID_BLEND_H_

#include <memory>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "interpolation/shear_limit.h"

namespace posespace {

enum class BlendMethod {
  kRigid,   // ours: mean rest shape, area weights, rotation refits
  kLinear,  // sum w_i p_i, for comparison
  kPaper,   // the paper's: rest shape = pose 0, unweighted, no refits
};

struct BlendOptions {
  BlendMethod method = BlendMethod::kRigid;
  ShearLimit shear_limit = ShearLimit::kBand;
  int refits = 3;  // 0 .. 3 rotation refits (method kRigid)
};

// Weights -> vertices: interpolates each triangle's rotation and stretch separately and finds the
// mesh that fits them best.
//
// Per triangle t and pose i, the map from a rest triangle to the pose is split as R(alpha) S.  A
// blend targets R(sum w_i alpha_i) (sum w'_i S_i), with w' the shear-limited weights, and solves
// min_V sum_t area_t |J_t V - target_t|^2 with one prefactored matrix; each refit replaces the
// rotations by those of the last solution and solves again.  The rest triangle is the mean over the
// poses of their metrics, so no pose is privileged.  Angles are unwrapped over the mesh, so parts
// that turn by more than half a turn keep turning.  The solution is placed so that its area-weighted
// centroid lies at the weighted mean of the poses' centroids.
//
// Guarantees: weights of one pose alone reproduce it; the result is unmoved by a common rigid motion
// of all poses (it moves along) and by their order.
//
// Immutable; share freely.  At() takes no lock.
// Follows   Baxter, Barla, Anjyo 2009, section 4.2.
class RigidBlend {
 public:
  // `turns` adds whole turns to each pose's rotation (N entries, or none for all zero): each pose's
  // area-weighted mean rotation relative to the rest shape is first brought into (-pi, pi], then
  // 2 pi turns[i] is added.
  //
  // Requires  a valid mesh.
  // Fails     kSizeMismatch (turns), kInternal (degenerate in every pose).
  static Result<RigidBlend> Prepare(const CompatibleMesh& mesh, std::vector<int> turns = {});

  // V x 2 vertices in drawing pixels for N finite weights that sum to one.
  // Cost O(N T) to assemble and one back-substitution per solve.
  Points At(const Eigen::VectorXd& weights, const BlendOptions& options = {}) const;

  // The area-weighted mean rotation of each pose relative to the rest shape, radians, in (-pi, pi]
  // before turns.
  const std::vector<double>& mean_rotations() const;
  const std::vector<int>& turns() const;

 private:
  struct Prepared;
  explicit RigidBlend(std::shared_ptr<const Prepared> prepared) : prepared_(std::move(prepared)) {}
  std::shared_ptr<const Prepared> prepared_;
};

// The whole turns that make neighbours in pose space (along a minimum spanning tree of the
// placements, N x 2) differ by at most half a turn in mean rotation; pose 0 keeps turn 0.
// Poses spread over more than half a turn are ambiguous by themselves: their placement says which
// way round they go.
std::vector<int> TurnsAlongPlacements(const std::vector<double>& mean_rotations,
                                      const Points& placements);

// How many triangles of `vertices` (V x 2) are not positive.
int CountFolds(const Triangles& triangles, const Points& vertices);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_RIGID_BLEND_H_
