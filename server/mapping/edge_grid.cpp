// SPDX-License-Identifier: Apache-2.0
#include "mapping/edge_grid.h"

#include <cmath>

namespace posespace {
namespace {

constexpr int kMaxSide = 256;  // bounds the cells that one long edge is listed in

}  // namespace

EdgeGrid::EdgeGrid(const Points& ring)
    : side_(std::clamp(static_cast<int>(std::sqrt(static_cast<double>(ring.rows()))), 1, kMaxSide)),
      low_(ring.colwise().minCoeff().transpose()),
      cells_(static_cast<std::size_t>(side_) * side_) {
  const Point extent = ring.colwise().maxCoeff().transpose() - low_;
  cells_per_unit_ = {side_ / extent.x(), side_ / extent.y()};
}

std::array<int, 2> EdgeGrid::CellOf(const Point& p) const {
  const auto index = [&](int axis) {
    const double cell = (p[axis] - low_[axis]) * cells_per_unit_[axis];
    return static_cast<int>(std::clamp(cell, 0.0, side_ - 1.0));
  };
  return {index(0), index(1)};
}

void EdgeGrid::Insert(int edge, const Point& a, const Point& b) {
  const auto [first_x, first_y] = CellOf(a.cwiseMin(b));
  const auto [last_x, last_y] = CellOf(a.cwiseMax(b));
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) cells_[y * side_ + x].push_back(edge);
  }
}

void EdgeGrid::Erase(int edge, const Point& a, const Point& b) {
  const auto [first_x, first_y] = CellOf(a.cwiseMin(b));
  const auto [last_x, last_y] = CellOf(a.cwiseMax(b));
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) std::erase(cells_[y * side_ + x], edge);
  }
}

}  // namespace posespace
