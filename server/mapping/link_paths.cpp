// SPDX-License-Identifier: Apache-2.0
#include "mapping/link_paths.h"

#include <algorithm>
#include <limits>
#include <span>

#include "geometry/polygon.h"
#include "mapping/visibility.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

double DistanceToSegment(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm();
}

double Clearance(const Point& p, const Points& ring) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    least = std::min(least, DistanceToSegment(p, ring.row(k), ring.row((k + 1) % ring.rows())));
  }
  return least;
}

}  // namespace

LinkPaths::LinkPaths(const Points& ring)
    : n_(static_cast<int>(ring.rows())),
      ring_(ring),
      bends_(static_cast<std::size_t>(n_) * n_, kNoPath) {
  PlaceSpots();
  Look();
  CountBends();
}

// In each triangle of the ring's own triangulation a point near the middle and one near each side.
// They are off all symmetries, so that few lie in line with two rows: paths should bend.
void LinkPaths::PlaceSpots() {
  constexpr double kShares[4][3] = {
      {0.35, 0.32, 0.33}, {0.13, 0.41, 0.46}, {0.47, 0.14, 0.39}, {0.42, 0.43, 0.15}};
  const auto triangles = TriangulateRings(std::span(&ring_, 1));
  if (!triangles) return;
  for (const auto& [i, k, j] : *triangles) {
    const Point a = ring_.row(i), b = ring_.row(k), c = ring_.row(j);
    for (const auto& share : kShares) {
      const Point spot = share[0] * a + share[1] * b + share[2] * c;
      if (Locate(spot, ring_) > 0) spots_.push_back(spot);
    }
  }
}

void LinkPaths::Look() {
  const int count = static_cast<int>(spots_.size());
  row_sees_.assign(static_cast<std::size_t>(n_) * count, 0);
  spot_sees_.assign(static_cast<std::size_t>(count) * count, 0);
  for (int c = 0; c < count; ++c) {
    int seen = 0;
    for (int i = 0; i < n_; ++i) {
      const bool sees = RowSeesPoint(ring_, i, spots_[c]);
      row_sees_[static_cast<std::size_t>(i) * count + c] = sees ? 1 : 0;
      seen += sees ? 1 : 0;
    }
    dearness_.push_back(n_ / (Clearance(spots_[c], ring_) * std::max(1, seen)));
    for (int d = 0; d < c; ++d) {
      const bool sees = PointSeesPoint(ring_, spots_[c], spots_[d]);
      spot_sees_[static_cast<std::size_t>(c) * count + d] = sees ? 1 : 0;
      spot_sees_[static_cast<std::size_t>(d) * count + c] = sees ? 1 : 0;
    }
  }
}

// Breadth first from each row, over spots only.
void LinkPaths::CountBends() {
  const int count = static_cast<int>(spots_.size());
  std::vector<int> bends, queue;
  for (int i = 0; i < n_; ++i) {
    bends.assign(count, kNoPath);
    queue.clear();
    for (int c = 0; c < count; ++c) {
      if (!RowSees(i, c)) continue;
      bends[c] = 1;
      queue.push_back(c);
    }
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (int c = 0; c < count; ++c) {
        if (bends[c] != kNoPath || !SpotSees(queue[head], c)) continue;
        bends[c] = bends[queue[head]] + 1;
        queue.push_back(c);
      }
    }
    for (int j = 0; j < n_; ++j) {
      for (int c = 0; c < count; ++c) {
        if (RowSees(j, c)) bends_[Index(i, j)] = std::min(bends_[Index(i, j)], bends[c]);
      }
    }
  }
}

std::optional<std::vector<Point>> LinkPaths::Path(int i, int j, int bends) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const int count = static_cast<int>(spots_.size());
  std::vector<std::vector<double>> cost(bends, std::vector<double>(count, kNone));
  std::vector<std::vector<int>> from(bends, std::vector<int>(count, -1));
  const auto leg = [&](const Point& p, int c) { return (p - spots_[c]).norm() * dearness_[c]; };
  const Point start = ring_.row(i), end = ring_.row(j);
  for (int c = 0; c < count; ++c) {
    if (RowSees(i, c)) cost[0][c] = leg(start, c);
  }
  for (int k = 1; k < bends; ++k) {
    for (int c = 0; c < count; ++c) {
      for (int d = 0; d < count; ++d) {
        if (!SpotSees(c, d) || cost[k - 1][d] == kNone) continue;
        const double total = cost[k - 1][d] + leg(spots_[d], c) + leg(spots_[c], d);
        if (total < cost[k][c]) {
          cost[k][c] = total;
          from[k][c] = d;
        }
      }
    }
  }
  int last = -1;
  double least = kNone;
  for (int c = 0; c < count; ++c) {
    if (!RowSees(j, c) || cost[bends - 1][c] == kNone) continue;
    const double total = cost[bends - 1][c] + leg(end, c);
    if (total < least) {
      least = total;
      last = c;
    }
  }
  if (last < 0) return std::nullopt;
  std::vector<Point> path(bends);
  for (int k = bends - 1; k >= 0; last = from[k--][last]) path[k] = spots_[last];
  return path;
}

}  // namespace posespace
