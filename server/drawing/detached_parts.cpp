// SPDX-License-Identifier: Apache-2.0
#include "drawing/detached_parts.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace posespace {
namespace {

// A bridge between two parts.
struct Bridge {
  int part_a, part_b;
  int squared_length;
  cv::Point end_a, end_b;

  auto Key() const {
    return std::tuple(part_a, part_b, squared_length, end_a.y, end_a.x, end_b.y, end_b.x);
  }
  bool operator<(const Bridge& other) const { return Key() < other.Key(); }
  bool operator==(const Bridge& other) const { return Key() == other.Key(); }
};

// The shortest bridge between each two parts whose Voronoi cells share a border, the middle one
// where many are equally short.  Like the edges of the Delaunay triangulation of points, these
// contain a shortest set that connects all parts.
std::vector<Bridge> NeighbourBridges(const cv::Mat1i& part_of) {
  cv::Mat1f distance;
  cv::Mat1i nearest;  // at each pixel, the number of the nearest pixel that is in a part
  cv::distanceTransform(part_of == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> place(part_of.total() + 1);
  for (int y = 0; y < part_of.rows; ++y) {
    for (int x = 0; x < part_of.cols; ++x) {
      if (part_of(y, x) != 0) place[nearest(y, x)] = {x, y};
    }
  }
  std::vector<Bridge> candidates;
  const auto consider = [&](int near_p, int near_q) {
    if (near_p == near_q) return;
    cv::Point a = place[near_p], b = place[near_q];
    if (part_of(a) == part_of(b)) return;
    if (part_of(a) > part_of(b)) std::swap(a, b);
    candidates.push_back({part_of(a), part_of(b), (a - b).dot(a - b), a, b});
  };
  for (int y = 0; y < nearest.rows; ++y) {
    for (int x = 0; x < nearest.cols; ++x) {
      if (x > 0) consider(nearest(y, x), nearest(y, x - 1));
      if (y > 0) consider(nearest(y, x), nearest(y - 1, x));
    }
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());

  std::vector<Bridge> bridges;
  for (auto first = candidates.begin(); first != candidates.end();) {
    const auto of_these_parts = [&](const Bridge& bridge) {
      return std::pair(bridge.part_a, bridge.part_b) == std::pair(first->part_a, first->part_b);
    };
    const auto end = std::partition_point(first, candidates.end(), of_these_parts);
    const auto longer = std::partition_point(first, end, [&](const Bridge& bridge) {
      return bridge.squared_length == first->squared_length;
    });
    bridges.push_back(first[(longer - first) / 2]);
    first = end;
  }
  return bridges;
}

}  // namespace

JoinedParts JoinParts(cv::Mat1b& mask, double smallest_share, int width) {
  cv::Mat1i part_of;
  cv::Mat1i stats;
  cv::Mat1d centroids;
  const int parts = cv::connectedComponentsWithStats(mask, part_of, stats, centroids, 8);
  int body = 1;
  double painted = 0.0;
  for (int part = 1; part < parts; ++part) {
    painted += stats(part, cv::CC_STAT_AREA);
    if (stats(part, cv::CC_STAT_AREA) > stats(body, cv::CC_STAT_AREA)) body = part;
  }
  JoinedParts joined;
  for (int x = stats(body, cv::CC_STAT_LEFT); x < mask.cols; ++x) {
    joined.body = {x, stats(body, cv::CC_STAT_TOP)};
    if (part_of(joined.body) == body) break;
  }

  // Only parts that count take part in what follows.
  std::vector<int> number(parts, 0);
  int counted = 0;
  for (int part = 1; part < parts; ++part) {
    const bool counts = stats(part, cv::CC_STAT_AREA) >= smallest_share * painted;
    if (counts || part == body) number[part] = ++counted;
  }
  if (counted < 2) return joined;
  for (int& part : part_of) part = number[part];

  // Kruskal's minimum spanning tree over the parts.
  std::vector<Bridge> bridges = NeighbourBridges(part_of);
  std::stable_sort(bridges.begin(), bridges.end(), [](const Bridge& a, const Bridge& b) {
    return a.squared_length < b.squared_length;
  });
  std::vector<int> parent(counted + 1);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int part) {
    while (parent[part] != part) part = parent[part] = parent[parent[part]];
    return part;
  };
  for (const Bridge& bridge : bridges) {
    const int a = root(bridge.part_a), b = root(bridge.part_b);
    if (a == b) continue;
    parent[a] = b;
    cv::line(mask, bridge.end_a, bridge.end_b, cv::Scalar(255), width);
    ++joined.bridges;
  }
  return joined;
}

}  // namespace posespace
