// SPDX-License-Identifier: Apache-2.0
#include "mapping/edge_grid.h"

namespace posespace {
namespace {

constexpr int kMaxSide = 256;       // bounds the cells that one long edge is listed in
constexpr double kRounding = 1e-9;  // / largest coordinate: a million times that of doubles

}  // namespace

EdgeGrid::EdgeGrid(const Points& ring)
    : side_(std::clamp(static_cast<int>(std::sqrt(static_cast<double>(ring.rows()))), 1, kMaxSide)),
      low_(ring.colwise().minCoeff().transpose()),
      rounding_(kRounding * ring.cwiseAbs().maxCoeff()),
      cells_(static_cast<std::size_t>(side_) * side_),
      seen_(ring.rows(), 0) {
  const Point extent = ring.colwise().maxCoeff().transpose() - low_;
  cells_per_unit_ = {side_ / extent.x(), side_ / extent.y()};
}

void EdgeGrid::Insert(int edge, const Point& a, const Point& b) {
  ForCellsNear(a, b, 0.0, [&](int cell) { cells_[cell].push_back(edge); });
}

void EdgeGrid::Erase(int edge, const Point& a, const Point& b) {
  ForCellsNear(a, b, 0.0, [&](int cell) { std::erase(cells_[cell], edge); });
}

}  // namespace posespace
