// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_POSE_WEIGHTS_H_
#define POSESPACE_INTERPOLATION_POSE_WEIGHTS_H_

#include <cstdint>
#include <memory>
#include <span>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"
#include "interpolation/biharmonic_fit.h"
#include "interpolation/pose_lattice.h"

namespace posespace {

struct PoseWeightsOptions {
  // Distance over which weights flatten far from the poses, / diameter of the placements.
  double levelling = 0.4;
};

// What is slow to find of pose weights, as plain numbers; empty for a single pose.
struct PoseWeightsFit {
  PoseLattice lattice = {};
  LatticeData data = {};  // 3 numbers a lattice vertex for each pose (biharmonic_fit.h)
};

// The weight of every pose at every point of the 2D pose space: N smooth functions that are exact
// at the placements and sum to one everywhere.
//
// Weights over poses, not over mesh vertices; the mesh solve is rigid_blend.h.
//
// The plane is tessellated with a near-equilateral lattice (pose_lattice.h) over the placements'
// bounding box and a margin of half their diameter; the weights minimise the jumps of their
// gradient over the lattice's edges (a discrete biharmonic energy) and, slightly, the gradient
// itself.  Between lattice vertices they are evaluated with Clough-Tocher cubics, so they are C1.
// Outside the domain each point takes the weights of the closest point of its rim; within 0.2
// diameters of the rim points are eased towards that, so weights are C1 across the rim and at its
// corners, too.
//
// Weights may be negative and exceed 1 (extrapolation): see shear_limit.h.
//
// Moving or scaling all placements together changes nothing but rounding, reordering them reorders
// the weights.  Turning them changes the box and the lattice: inside the poses' hull that moves
// weights by about 1e-2, near the rim by more.
//
// Immutable; share freely.  At() allocates nothing but its result and takes no lock.
// Follows   Baxter, Barla, Anjyo 2009, section 4.1, equations (1) and (2).
class PoseWeights {
 public:
  // Requires  placements N x 2, N >= 1, row i the place of pose i in pose space, any unit.
  // Fails     kNoShapes (N = 0), kPlacementNotFinite (also when distances overflow),
  //           kPlacementsCoincide (names both rows; closer than 1e-3 of the diameter),
  //           kInvalidOption (levelling outside [0.01, 100]), kCancelled.
  // Cost      one sparse factorisation of some 11,000 unknowns at most, and some 500 more per pose
  //           that is close to another: well under a second.
  static Result<PoseWeights> Fit(const Points& placements, const PoseWeightsOptions& options = {},
                                 Progress* progress = nullptr);

  // What Fit found, and the weights that it found for those placements, the same to the last bit,
  // in a small part of the time.
  // Fails     as Fit does; kSizeMismatch (not a fit of these placements), kWeightsNotFinite.
  PoseWeightsFit fit() const;
  static Result<PoseWeights> FromFit(const Points& placements, PoseWeightsFit fit);

  // The N weights at a finite point; the second allocates nothing.
  Eigen::VectorXd At(const Point& point) const;
  void At(const Point& point, std::span<double> weights) const;

  int num_poses() const;

  // About how much memory it takes.
  std::int64_t MemoryBytes() const;

 private:
  struct Field;
  explicit PoseWeights(std::shared_ptr<const Field> field) : field_(std::move(field)) {}
  std::shared_ptr<const Field> field_;
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_POSE_WEIGHTS_H_
