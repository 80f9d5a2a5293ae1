// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_CUT_STAGES_H_
#define POSESPACE_MAPPING_CUT_STAGES_H_

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "mapping/ring_programme.h"
#include "mapping/triangulation_levels.h"

namespace posespace {

// One side of a cut: which rows of the cut rings are its own, in order; n + b is bend b.
struct CutSide {
  std::vector<int> rows;
  // Its triangulation without further Steiner vertices, in indices of `rows`, if it has one.
  std::optional<std::vector<Triangle>> triangles;
};

// A path from one row to another that cuts N rings of n rows in two the same way.
struct Cut {
  Level level;                // which stage found it
  std::vector<Points> bends;  // per ring: b x 2, its Steiner vertices, from one end to the other
  std::array<CutSide, 2> sides;
};

// The paper's stages, in order, until one finds a cut:
//
//   I    a chord that is a diagonal of every ring
//   II   a path over one Steiner vertex that sees both ends, in every ring
//   III  a path of few Steiner vertices (link_paths.h), as many in every ring
//
// A stage prefers cuts with sides that need no further Steiner vertex, then balanced ones with wide
// angles.  Both sides are simple rings everywhere (exact).  A side without a triangulation has
// fewer rows than the whole, so that cutting comes to an end.  Nothing when no cut does, when the
// rings have so many rows that an overlay is the better use of time, or when cancelled.
//
// Requires  N >= 1 simple, positively oriented rings of n rows that share no triangulation.
// Cost      O(N n^3), a few tens of times.
// Follows   Baxter, Barla, Anjyo 2009, section 3.1, "Compatible triangulation".
std::optional<Cut> FindCut(std::span<const Points> rings, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_CUT_STAGES_H_
