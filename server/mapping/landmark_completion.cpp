// SPDX-License-Identifier: Apache-2.0
#include "mapping/landmark_completion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace posespace {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeastGap = 1e-3;  // turns that a found place keeps from others, if it can

double TurnsFrom(double begin, double end) { return end - begin - std::floor(end - begin); }

// `wanted` itself, or a place nearby that lies on the arc from `before` to `after`.
double PlaceOnArc(double wanted, double before, double after) {
  const double length = before == after ? 1.0 : TurnsFrom(before, after);
  const double gap = std::min(kLeastGap, 0.25 * length);
  const double ahead = TurnsFrom(before, wanted);
  // Off the arc, the nearer end is the better one.
  const bool past_begin = ahead > 0.5 * (length + 1.0);
  return before + (past_begin ? gap : std::clamp(ahead, gap, length - gap));
}

}  // namespace

std::vector<Anchor> CommonAnchors(const std::vector<int>& order, const LandmarkPositions& positions,
                                  int a, int b) {
  std::vector<Anchor> anchors;
  for (const int l : order) {
    const double on_a = positions[l][a], on_b = positions[l][b];
    if (!std::isnan(on_a) && !std::isnan(on_b)) anchors.push_back({on_a, on_b});
  }
  return anchors;
}

LandmarkPositions CompleteLandmarks(const Marks& marks, const std::vector<int>& order,
                                    const MatchingTree& tree, const AnchoredMatch& match) {
  LandmarkPositions positions;
  for (const auto& on : marks.on) {
    auto& row = positions.emplace_back();
    for (const auto& mark : on) row.push_back(mark ? mark->position : kAbsent);
  }
  const int count = static_cast<int>(order.size());

  // Copies to drawing `to` what drawing `from` has and it lacks.
  const auto carry = [&](int from, int to) {
    const auto is_missing = [&](int l) {
      return std::isnan(positions[l][to]) && !std::isnan(positions[l][from]);
    };
    if (std::none_of(order.begin(), order.end(), is_missing)) return;
    const OutlineMap map = match(from, to, CommonAnchors(order, positions, from, to));
    for (int k = 0; k < count; ++k) {
      if (!is_missing(order[k])) continue;
      // The nearest landmarks that `to` has before and after this one in the common order.
      int before = k, after = k;
      do before = (before + count - 1) % count;
      while (before != k && std::isnan(positions[order[before]][to]));
      do after = (after + 1) % count;
      while (after != k && std::isnan(positions[order[after]][to]));
      double& place = positions[order[k]][to];
      place = map.At(positions[order[k]][from]);
      if (before != k) {
        place = PlaceOnArc(place, positions[order[before]][to], positions[order[after]][to]);
      }
      place -= std::floor(place);
    }
  };
  for (auto i = tree.order.rbegin(); i != tree.order.rend(); ++i) {
    if (tree.parent[*i] >= 0) carry(*i, tree.parent[*i]);
  }
  for (const int i : tree.order) {
    if (tree.parent[i] >= 0) carry(tree.parent[i], i);
  }
  return positions;
}

}  // namespace posespace
