// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_VISIBILITY_H_
#define POSESPACE_MAPPING_VISIBILITY_H_

#include "geometry/mesh.h"

// Who sees whom inside a simple, positively oriented ring: the segment between them touches the
// ring nowhere but at its own ends.  Exact; points must lie strictly inside.  Cost O(n).

namespace posespace {

// True when the ray from row i to row j starts inside the ring.
bool StartsInside(const Points& ring, int i, int j);

bool RowSeesRow(const Points& ring, int i, int j);
bool RowSeesPoint(const Points& ring, int i, const Point& p);
bool PointSeesPoint(const Points& ring, const Point& p, const Point& q);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_VISIBILITY_H_
