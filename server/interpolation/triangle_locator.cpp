// SPDX-License-Identifier: Apache-2.0
#include "interpolation/triangle_locator.h"

#include <algorithm>
#include <cmath>

namespace posespace {
namespace {

// For each triangle the one opposite each corner.
Triangles AcrossEdges(const Triangles& triangles) {
  Triangles across = Triangles::Constant(triangles.rows(), 3, -1);
  const auto corner_opposite = [&](int t, int a, int b) {
    int k = 0;
    while (triangles(t, k) == a || triangles(t, k) == b) ++k;
    return k;
  };
  const Edges edges = EdgesOf(triangles);
  for (const auto& edge : edges.rowwise()) {
    const int a = edge[0], b = edge[1], left = edge[2], right = edge[3];
    if (right < 0) continue;
    across(left, corner_opposite(left, a, b)) = right;
    across(right, corner_opposite(right, a, b)) = left;
  }
  return across;
}

}  // namespace

TriangleLocator::TriangleLocator(Points vertices, Triangles triangles, const Point& size,
                                 double cell)
    : vertices_(std::move(vertices)),
      triangles_(std::move(triangles)),
      across_(AcrossEdges(triangles_)),
      columns_(std::max(1, static_cast<int>(std::ceil(size.x() / cell)))),
      rows_(std::max(1, static_cast<int>(std::ceil(size.y() / cell)))),
      cell_(cell) {
  start_.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Point centre((column + 0.5) * cell_, (row + 0.5) * cell_);
      const int last = start_.empty() ? 0 : start_[start_.size() - (column > 0 ? 1 : columns_)];
      start_.push_back(Walk(centre.cwiseMin(size), last).triangle);
    }
  }
}

Eigen::Vector3d TriangleLocator::Barycentric(const Point& point, int triangle) const {
  const Point a = vertices_.row(triangles_(triangle, 0)).transpose();
  const Point b = vertices_.row(triangles_(triangle, 1)).transpose();
  const Point c = vertices_.row(triangles_(triangle, 2)).transpose();
  const double area = Cross(a, b, c);
  const double at_b = Cross(a, point, c) / area, at_c = Cross(a, b, point) / area;
  return {1.0 - at_b - at_c, at_b, at_c};
}

TrianglePlace TriangleLocator::Walk(const Point& point, int start) const {
  // Rounding alone must not send the walk across an edge that the point lies on.
  constexpr double kOutside = -1e-12;
  TrianglePlace place{start, Barycentric(point, start)};
  for (Eigen::Index step = 0; step < triangles_.rows(); ++step) {
    int lowest = 0;
    if (place.barycentric.minCoeff(&lowest) >= kOutside) return place;
    const int next = across_(place.triangle, lowest);
    if (next < 0) break;
    place = {next, Barycentric(point, next)};
  }

  // Only where triangles are far from Delaunay may a walk circle or stop early.
  for (int t = 0; t < static_cast<int>(triangles_.rows()); ++t) {
    const Eigen::Vector3d barycentric = Barycentric(point, t);
    if (barycentric.minCoeff() > place.barycentric.minCoeff()) place = {t, barycentric};
  }
  return place;
}

int TriangleLocator::CellOf(const Point& point) const {
  const int column = std::clamp(static_cast<int>(point.x() / cell_), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(point.y() / cell_), 0, rows_ - 1);
  return row * columns_ + column;
}

TrianglePlace TriangleLocator::Find(const Point& point) const {
  return Walk(point, start_[CellOf(point)]);
}

}  // namespace posespace
