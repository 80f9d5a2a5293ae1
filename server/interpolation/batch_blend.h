// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BATCH_BLEND_H_
#define POSESPACE_INTERPOLATION_BATCH_BLEND_H_

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "interpolation/rigid_blend.h"

namespace posespace {

// One pose to find.
struct BlendJob {
  std::span<const double> weights;  // N, finite, sum 1
  float* vertices;                  // takes x0 y0 x1 y1 ... of V vertices, drawing pixels
  int folds = 0;                    // takes how many of their triangles are not positive
  int mended = 0;                   // takes how many more were not, before repair
};

// RigidBlend's vertices as they travel, in float32, fast: one pose alone, or many of the same pose
// space together in the lanes of the processor's vectors.
//
// The rigid method with linear stretch is solved in float with a matrix factored in double
// (block_factor.h, blend_kernel.h).  Everything else is RigidBlend's own result, rounded; repair is
// RigidBlend::Mended.
//
// A pose's vertices do not depend on what they are solved together with: the same bits come out
// alone, in any batch and at any place of it.
//
// Error     against RigidBlend::At: at most 5e-6 of the size (the root of the poses' mean area)
//           times sum |w_i|, mostly a tenth of it; for threads more than a hundred times as long as
//           wide 2e-6 of their length.  And float32's rounding of coordinates.
// Memory    kept by each thread that blends, as much as its largest blend needed: some 60 bytes a
//           vertex and lane, alone 120 a vertex.
//
// Immutable; share freely.  Blending takes no lock.  In float it allocates nothing after a thread's
// first blend of its size, unless a part of the mesh folds away to nothing.
class BatchBlend {
 public:
  // Requires and fails  as RigidBlend::Prepare.
  static Result<BatchBlend> Prepare(const CompatibleMesh& mesh, std::vector<int> turns = {});

  // Fills vertices, folds and mended of all jobs.
  void Solve(std::span<BlendJob> jobs, const BlendOptions& options) const;

  const RigidBlend& exact() const;
  std::size_t factor_bytes() const;  // of the factor that every solve reads once

 private:
  struct Tables;
  explicit BatchBlend(std::shared_ptr<const Tables> tables) : tables_(std::move(tables)) {}
  std::shared_ptr<const Tables> tables_;
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BATCH_BLEND_H_
