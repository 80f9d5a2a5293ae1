// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_RIGID_BLEND_H_
#define POSESPACE_INTERPOLATION_RIGID_BLEND_H_

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "interpolation/anchor.h"
#include "interpolation/rigid_model.h"
#include "interpolation/shear_limit.h"

namespace posespace {

// A frame's vertices, as they travel.
using FloatPoints = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;  // V x 2

enum class BlendMethod {
  kRigid,   // ours: mean rest shape, area weights, rotation refits
  kLinear,  // sum w_i p_i, for comparison
  kPaper,   // the paper's: rest shape = pose 0, unweighted, no refits
};

// How stretches are mixed (method kRigid).
enum class StretchBlend {
  kLinear,  // sum w'_i S_i: lengths in the mean
  kLog,     // exp(sum w'_i log S_i): lengths multiply; never inverts, whatever the weights
  kMetric,  // sqrt(sum w'_i S_i^2): squared lengths in the mean
};

struct BlendOptions {
  BlendMethod method = BlendMethod::kRigid;
  ShearLimit shear_limit = ShearLimit::kBand;
  int refits = 3;  // 0 .. 3 rotation refits (method kRigid)
  StretchBlend stretch = StretchBlend::kLinear;
  bool repair = false;  // unfold the result where it folds, at the cost of milliseconds
  std::optional<MeshPoint> anchor = {};  // place the result by it instead of by centroids

  bool operator==(const BlendOptions&) const = default;
};

// Weights -> vertices: interpolates each triangle's rotation and stretch separately and finds the
// mesh that fits them best.
//
// Per triangle t and pose i, the map from a rest triangle to the pose is split as R(alpha) S, S
// symmetric.  A blend targets R(sum w_i alpha_i) (sum w'_i S_i), with w' the shear-limited weights
// (the stretch may be mixed otherwise), and solves min_V sum_t mass_t |J_t V - target_t|^2, mass_t
// the area of the rest triangle, more where a pose makes it small (triangle_maps.cpp), with one
// prefactored matrix; each refit replaces the rotations by those nearest to J_t S_t of the last
// solution and solves again.
//
// Rest shape    The metric of a rest triangle is the mean of the poses' E_i'E_i (E_i its edge
//               vectors in pose i), so no pose is privileged; it is turned so that pose 0 maps it
//               without rotation.  kPaper: pose 0 itself, every mass_t = 1.
// Rotations     are unwrapped over the mesh, so parts that turn by more than half a turn keep
//               turning.
// Placement     The area centroid of the result lies at sum w_i c_i, c_i the area centroid of pose
//               i.  An area centroid is sum_t a_t m_t / sum_t a_t over the mesh's own triangles:
//               a_t signed area, m_t mean of the corners; with |a_t| instead where folds leave less
//               than 1/1000 of the area.  (kLinear needs no placing.)  With an anchor the result is
//               then moved as a whole so that the anchor lies at sum w_i times its place in pose i:
//               a foot that stands in all poses stands.
// Parts         of a mesh that share no edge are unwrapped, those that share no vertex placed, each
//               by itself.
//
// Guarantees: weights of one pose alone reproduce it; the result is unmoved by a common rigid
// motion of all poses (it moves along).  It is unmoved by their order as long as all their mean
// rotations lie within half a turn; wider spread is ambiguous, and the turns decide.
//
// Immutable; share freely.  At() takes no lock.
// Follows   Baxter, Barla, Anjyo 2009, section 4.2.
class RigidBlend {
 public:
  // `turns` adds whole turns to each pose's rotation (N entries, or none for all zero): each pose's
  // mean rotation relative to the rest shape, weighted with the rest areas, is first brought into
  // (-pi, pi] (half a turn, but for rounding, is +pi), then 2 pi turns[i] is added.  kPaper takes
  // the same whole turns as kRigid.
  //
  // Requires  a valid mesh.
  // Fails     kSizeMismatch (turns), kInternal (empty, a vertex without triangle, or a triangle
  //           that is degenerate in every pose).
  static Result<RigidBlend> Prepare(const CompatibleMesh& mesh, std::vector<int> turns = {});

  // V x 2 vertices in drawing pixels for N finite weights that sum to one.
  // Cost O(N T) to assemble and one back-substitution per solve; kLog takes a logarithm a triangle
  // and pose, too.
  Points At(const Eigen::VectorXd& weights, const BlendOptions& options = {}) const;

  // `vertices`, a blend at these weights, unfolded (fold_repair.h): with each triangle positive if
  // that can be, and as near to its target as the others allow.  Unchanged where targets themselves
  // have no area, as extrapolation without shear limiting makes them.  The targets of kLinear are
  // kRigid's.
  Points Mended(const Points& vertices, const Eigen::VectorXd& weights,
                const BlendOptions& options) const;

  // Moves all of `vertices`, a blend at these weights, so that the anchor lies in its place.
  void Hold(const MeshPoint& anchor, const Eigen::VectorXd& weights, Points* vertices) const;

  // The area-weighted mean rotation of each pose relative to the rest shape, radians, in (-pi, pi]
  // before turns.
  const std::vector<double>& mean_rotations() const;
  const std::vector<int>& turns() const;

  const RigidModel& model() const;  // what batch_blend.h blends, too

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
int CountFolds(const Triangles& triangles, std::span<const float> coordinates);  // x0 y0 x1 y1 ...

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_RIGID_BLEND_H_
