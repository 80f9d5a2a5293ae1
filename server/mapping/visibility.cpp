// SPDX-License-Identifier: Apache-2.0
#include "mapping/visibility.h"

#include <algorithm>

#include "geometry/polygon.h"

namespace posespace {
namespace {

// True when the segment ab meets no edge of the ring but those at rows i and j (-1: none), and
// passes over no neighbour of these rows.
bool IsFree(const Points& ring, const Point& a, const Point& b, int i, int j) {
  const int n = static_cast<int>(ring.rows());
  const double left = std::min(a.x(), b.x()), right = std::max(a.x(), b.x());
  const double top = std::min(a.y(), b.y()), bottom = std::max(a.y(), b.y());
  for (int k = 0; k < n; ++k) {
    const int next = k + 1 < n ? k + 1 : 0;
    if (std::max(ring(k, 0), ring(next, 0)) < left || std::min(ring(k, 0), ring(next, 0)) > right ||
        std::max(ring(k, 1), ring(next, 1)) < top || std::min(ring(k, 1), ring(next, 1)) > bottom) {
      continue;
    }
    const bool at_k = k == i || k == j, at_next = next == i || next == j;
    if (at_k && at_next) return false;
    const bool met = at_k      ? IsOnSegment(ring.row(next), a, b)
                     : at_next ? IsOnSegment(ring.row(k), a, b)
                               : SegmentsMeet(a, b, ring.row(k), ring.row(next));
    if (met) return false;
  }
  return true;
}

}  // namespace

bool StartsInside(const Points& ring, int i, int j) {
  const int n = static_cast<int>(ring.rows());
  const Point at = ring.row(i), to = ring.row(j);
  const Point before = ring.row((i + n - 1) % n), after = ring.row((i + 1) % n);
  const bool convex = Orientation(before, at, after) >= 0;
  return convex ? Orientation(at, after, to) > 0 && Orientation(at, to, before) > 0
                : Orientation(at, after, to) > 0 || Orientation(at, to, before) > 0;
}

bool RowSeesRow(const Points& ring, int i, int j) {
  return i != j && StartsInside(ring, i, j) && IsFree(ring, ring.row(i), ring.row(j), i, j);
}

bool RowSeesPoint(const Points& ring, int i, const Point& p) {
  return IsFree(ring, ring.row(i), p, i, -1);
}

bool PointSeesPoint(const Points& ring, const Point& p, const Point& q) {
  return IsFree(ring, p, q, -1, -1);
}

}  // namespace posespace
