// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_LINK_PATHS_H_
#define POSESPACE_MAPPING_LINK_PATHS_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Paths between the rows of a ring that run strictly inside it and bend at spots: points spread
// over its inside, about four to a row.  Immutable after construction.
//
// Requires  a simple, positively oriented ring.
// Cost      O(n^3) exact tests to construct.
// Follows   Baxter, Barla, Anjyo 2009, section 3.1, stages II and III.
class LinkPaths {
 public:
  static constexpr int kNoPath = 1 << 20;

  explicit LinkPaths(const Points& ring);

  // The fewest bends of a path from row i to row j; kNoPath when none was found.  No path is
  // straight: RowSeesRow tells those.
  int Bends(int i, int j) const { return bends_[Index(i, j)]; }

  // The bends of a path from row i to row j with exactly so many, clear of the ring and at spots
  // that see much of it; nothing when there is none.  It may cross itself when `bends` > 2.
  // Cost O(bends C^2) for C spots.
  std::optional<std::vector<Point>> Path(int i, int j, int bends) const;

 private:
  std::size_t Index(int i, int j) const { return static_cast<std::size_t>(i) * n_ + j; }
  bool RowSees(int row, int spot) const {
    return row_sees_[static_cast<std::size_t>(row) * spots_.size() + spot] != 0;
  }
  bool SpotSees(int a, int b) const {
    return spot_sees_[static_cast<std::size_t>(a) * spots_.size() + b] != 0;
  }
  void PlaceSpots();
  void Look();
  void CountBends();

  int n_;
  Points ring_;
  std::vector<Point> spots_;
  std::vector<double> dearness_;  // per spot: what a unit of path costs there
  std::vector<std::uint8_t> row_sees_, spot_sees_;
  std::vector<int> bends_;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_LINK_PATHS_H_
