// SPDX-License-Identifier: Apache-2.0
#include "drawing/raster_ring.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace posespace {
namespace {

Points PointsFrom(const std::vector<Point>& rows) {
  Points points(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(k) = rows[k].transpose();
  return points;
}

double SquaredDistance(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * along).squaredNorm();
}

}  // namespace

Points TraceRing(const cv::Mat1i& labels, cv::Point start, Connectivity connectivity) {
  const int label = labels(start);
  std::vector<Point> ring;
  cv::Point inside = start;
  cv::Point outward(0, -1);
  do {
    ring.emplace_back(inside.x + 0.5 + 0.5 * outward.x, inside.y + 0.5 + 0.5 * outward.y);
    // The ring leaves this midpoint through the cell of four pixel centres that lies ahead.
    const cv::Point ahead(-outward.y, outward.x);
    const bool ahead_in = labels(inside + ahead) == label;
    const bool across_in = labels(inside + ahead + outward) == label;
    if (across_in && (ahead_in || connectivity == Connectivity::kEight)) {
      inside += ahead + outward;
      outward = -ahead;
    } else if (ahead_in) {
      inside += ahead;
    } else {
      outward = ahead;
    }
  } while (inside != start || outward != cv::Point(0, -1));
  return PointsFrom(ring);
}

Points SimplifyRing(const Points& ring, double tolerance) {
  const int n = static_cast<int>(ring.rows());
  const auto row = [&](int k) -> Point { return ring.row(k % n).transpose(); };
  // The row in (first, last) furthest from edge (first, last), with its squared distance.
  const auto furthest = [&](int first, int last) {
    std::pair<double, int> found{-1.0, first};
    for (int k = first + 1; k < last; ++k) {
      const double distance = SquaredDistance(row(k), row(first), row(last));
      if (distance > found.first) found = {distance, k};
    }
    return found;
  };

  std::vector<char> kept(n, 0);
  const int opposite = furthest(0, n).second;
  kept[0] = kept[opposite] = 1;
  std::vector<std::pair<int, int>> chains{{0, opposite}, {opposite, n}};
  while (!chains.empty()) {
    const auto [first, last] = chains.back();
    chains.pop_back();
    const auto [distance, middle] = furthest(first, last);
    if (distance <= tolerance * tolerance) continue;
    kept[middle] = 1;
    chains.emplace_back(first, middle);
    chains.emplace_back(middle, last);
  }
  std::vector<Point> rows;
  for (int k = 0; k < n; ++k) {
    if (kept[k]) rows.push_back(row(k));
  }
  return PointsFrom(rows);
}

Points DivideEdges(const Points& ring, double length) {
  std::vector<Point> rows;
  for (int k = 0; k < ring.rows(); ++k) {
    const Point a = ring.row(k).transpose(), b = ring.row((k + 1) % ring.rows()).transpose();
    const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / length)));
    for (int i = 0; i < pieces; ++i) rows.push_back(a + (b - a) * i / pieces);
  }
  return PointsFrom(rows);
}

}  // namespace posespace
