// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_EDGE_GRID_H_
#define POSESPACE_MAPPING_EDGE_GRID_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Finds the edges of a changing ring that may lie near a segment: a uniform grid over the ring's
// bounding box, each edge listed in the cells that it runs through.  What lies outside counts to
// the border cells, so edges may leave the box.  One per ring; not for concurrent use.
class EdgeGrid {
 public:
  // Over the bounding box of `ring`, with about as many cells as the ring has edges.
  explicit EdgeGrid(const Points& ring);

  void Insert(int edge, const Point& a, const Point& b);
  void Erase(int edge, const Point& a, const Point& b);  // as it was inserted

  // True when `predicate(edge)` holds for an edge that may come within `reach` of segment (a, b).
  // Every edge that does is asked about; some that do not, too.  An edge is asked about once.
  template <typename Predicate>
  bool AnyNear(const Point& a, const Point& b, double reach, const Predicate& predicate) const {
    ++query_;
    bool found = false;
    ForCellsNear(a, b, reach, [&](int cell) {
      for (const int edge : cells_[cell]) {
        if (found) return;
        if (seen_[edge] == query_) continue;
        seen_[edge] = query_;
        found = predicate(edge);
      }
    });
    return found;
  }

 private:
  // Visits the cells that come within `reach` of segment (a, b), row by row.
  template <typename Visit>
  void ForCellsNear(const Point& a, const Point& b, double reach, const Visit& visit) const {
    const Point &upper = a.y() <= b.y() ? a : b, &lower = a.y() <= b.y() ? b : a;
    const double height = lower.y() - upper.y();
    const double margin = reach + rounding_;
    const int last = Row(lower.y() + margin);
    for (int y = Row(upper.y() - margin); y <= last; ++y) {
      // The part of the segment beside this row; the border rows go on for ever.
      const double top = low_.y() + y / cells_per_unit_.y() - margin;
      const double bottom = low_.y() + (y + 1) / cells_per_unit_.y() + margin;
      double from = 0.0, to = 1.0;
      if (height > 0.0) {
        if (y > 0) from = std::clamp((top - upper.y()) / height, 0.0, 1.0);
        if (y + 1 < side_) to = std::clamp((bottom - upper.y()) / height, 0.0, 1.0);
      }
      const double width = lower.x() - upper.x();
      const auto [left, right] = std::minmax({upper.x() + from * width, upper.x() + to * width});
      const int end = Column(right + margin);
      for (int x = Column(left - margin); x <= end; ++x) visit(y * side_ + x);
    }
  }

  int Column(double x) const { return Cell((x - low_.x()) * cells_per_unit_.x()); }
  int Row(double y) const { return Cell((y - low_.y()) * cells_per_unit_.y()); }
  int Cell(double at) const { return static_cast<int>(std::clamp(at, 0.0, side_ - 1.0)); }

  int side_;
  Point low_;
  Point cells_per_unit_;
  double rounding_;  // covers what the arithmetic of cells may be wrong by
  std::vector<std::vector<int>> cells_;
  mutable std::vector<int> seen_;  // per edge, the last query that asked about it
  mutable int query_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_EDGE_GRID_H_
