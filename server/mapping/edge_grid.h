// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_EDGE_GRID_H_
#define POSESPACE_MAPPING_EDGE_GRID_H_

#include <algorithm>
#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Finds the edges of a changing ring that may lie near a box: a uniform grid over the ring's
// bounding box, each edge listed in every cell that its own box overlaps.  What lies outside counts
// to the border cells, so edges may leave the box.  One per ring; not for concurrent use.
class EdgeGrid {
 public:
  // Over the bounding box of `ring`, with about as many cells as the ring has edges.
  explicit EdgeGrid(const Points& ring);

  void Insert(int edge, const Point& a, const Point& b);
  void Erase(int edge, const Point& a, const Point& b);  // as it was inserted

  // True when `predicate(edge)` holds for an edge listed in a cell that meets the box from `low` to
  // `high`.  An edge may be asked about more than once.
  template <typename Predicate>
  bool AnyNear(const Point& low, const Point& high, const Predicate& predicate) const {
    const auto [first_x, first_y] = CellOf(low);
    const auto [last_x, last_y] = CellOf(high);
    for (int y = first_y; y <= last_y; ++y) {
      for (int x = first_x; x <= last_x; ++x) {
        const std::vector<int>& cell = cells_[y * side_ + x];
        if (std::any_of(cell.begin(), cell.end(), predicate)) return true;
      }
    }
    return false;
  }

 private:
  std::array<int, 2> CellOf(const Point& p) const;

  int side_;
  Point low_;
  Point cells_per_unit_;
  std::vector<std::vector<int>> cells_;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_EDGE_GRID_H_
