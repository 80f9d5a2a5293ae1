// SPDX-License-Identifier: Apache-2.0
#include "drawing/detached_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace posespace {
namespace {

// A bridge between two parts, ordered by length first.
struct Bridge {
  int squared_length;
  int part_a, part_b;
  cv::Point end_a, end_b;

  auto Key() const {
    return std::tuple(squared_length, part_a, part_b, end_a.y, end_a.x, end_b.y, end_b.x);
  }
  bool operator<(const Bridge& other) const { return Key() < other.Key(); }
};

// The shortest bridge between each two parts whose Voronoi cells share a border.  Like the edges of
// the Delaunay triangulation of points, these contain a shortest set that connects all parts.
std::vector<Bridge> NeighbourBridges(const cv::Mat1i& part_of) {
  cv::Mat1f distance;
  cv::Mat1i nearest;  // at each pixel, the number of the nearest pixel that is in a part
  cv::distanceTransform(part_of == 0, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5,
                        cv::DIST_LABEL_PIXEL);
  std::vector<cv::Point> place(static_cast<std::size_t>(part_of.total()) + 1);
  for (int y = 0; y < part_of.rows; ++y) {
    for (int x = 0; x < part_of.cols; ++x) {
      if (part_of(y, x) != 0) place[nearest(y, x)] = {x, y};
    }
  }
  std::map<std::pair<int, int>, Bridge> shortest;
  const auto consider = [&](int near_p, int near_q) {
    cv::Point a = place[near_p], b = place[near_q];
    if (part_of(a) == part_of(b)) return;
    if (part_of(a) > part_of(b)) std::swap(a, b);
    const Bridge bridge{(a - b).dot(a - b), part_of(a), part_of(b), a, b};
    const auto [known, is_new] = shortest.try_emplace({bridge.part_a, bridge.part_b}, bridge);
    if (!is_new && bridge < known->second) known->second = bridge;
  };
  for (int y = 0; y < nearest.rows; ++y) {
    for (int x = 0; x < nearest.cols; ++x) {
      if (x > 0 && nearest(y, x) != nearest(y, x - 1)) consider(nearest(y, x), nearest(y, x - 1));
      if (y > 0 && nearest(y, x) != nearest(y - 1, x)) consider(nearest(y, x), nearest(y - 1, x));
    }
  }
  std::vector<Bridge> bridges;
  for (const auto& [parts, bridge] : shortest) bridges.push_back(bridge);
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
  std::sort(bridges.begin(), bridges.end());
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
