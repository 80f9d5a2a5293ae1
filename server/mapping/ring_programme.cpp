// SPDX-License-Identifier: Apache-2.0
#include "mapping/ring_programme.h"

#include "geometry/polygon.h"

namespace posespace {
namespace {

// True when the ray from row i to row j starts inside the ring.
bool StartsInside(const Points& ring, int i, int j) {
  const int n = static_cast<int>(ring.rows());
  const Point at = ring.row(i), to = ring.row(j);
  const Point before = ring.row((i + n - 1) % n), after = ring.row((i + 1) % n);
  const bool convex = Orientation(before, at, after) >= 0;
  return convex ? Orientation(at, after, to) > 0 && Orientation(at, to, before) > 0
                : Orientation(at, after, to) > 0 || Orientation(at, to, before) > 0;
}

}  // namespace

void ChordTable::KeepChordsInside(const Points& ring) {
  for (int i = 0; i < n_; ++i) {
    for (int j = i + 2; j < n_; ++j) {
      if (i == 0 && j == n_ - 1) continue;
      if (Allows(i, j) && !(StartsInside(ring, i, j) && StartsInside(ring, j, i))) Forbid(i, j);
    }
  }
}

}  // namespace posespace
