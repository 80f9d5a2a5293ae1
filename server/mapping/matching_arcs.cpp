// SPDX-License-Identifier: Apache-2.0
#include "mapping/matching_arcs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace posespace {
namespace {

constexpr int kLeastIntervals = 4;  // of the shortest arc between anchors

double TurnsFrom(double begin, double end) {
  const double turns = end - begin;
  return turns - std::floor(turns);
}

}  // namespace

std::vector<Arc> ArcsBetween(const std::vector<Anchor>& anchors) {
  std::vector<Arc> arcs;
  if (anchors.size() == 1) return {{anchors[0], 1.0, 1.0}};
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const Anchor &begin = anchors[k], &end = anchors[(k + 1) % anchors.size()];
    arcs.push_back({begin, TurnsFrom(begin.on_a, end.on_a), TurnsFrom(begin.on_b, end.on_b)});
  }
  return arcs;
}

int IntervalsOf(const Arc& arc, int samples_per_turn) {
  const double share = 0.5 * (arc.length_a + arc.length_b);
  return std::max(kLeastIntervals, static_cast<int>(std::lround(share * samples_per_turn)));
}

std::vector<double> Samples(double begin, double length, int intervals) {
  std::vector<double> positions(intervals + 1);
  for (int k = 0; k <= intervals; ++k) positions[k] = begin + length * k / intervals;
  return positions;
}

Eigen::MatrixXd FeaturesOf(const OutlineCurve& curve, const std::vector<double>& positions,
                           const PairWeights& weights) {
  Eigen::MatrixXd features = curve.Features(positions, weights.position);
  if (weights.thickness > 0.0) {
    features.conservativeResize(Eigen::NoChange, features.cols() + 1);
    features.rightCols<1>() = std::sqrt(weights.thickness) * curve.LogThickness(positions);
  }
  if (weights.colour <= 0.0) return features;
  features.conservativeResize(Eigen::NoChange, features.cols() + 3);
  features.rightCols<3>() = std::sqrt(weights.colour) * curve.Colours(positions);
  return features;
}

void ArcsToMap::Append(const Arc& arc, const Alignment& alignment, int intervals) {
  const double turn_a =
      from_.empty() ? arc.begin.on_a : from_.back() + TurnsFrom(from_.back(), arc.begin.on_a);
  const double turn_b =
      to_.empty() ? arc.begin.on_b : to_.back() + TurnsFrom(to_.back(), arc.begin.on_b);
  for (std::size_t k = 0; k + 1 < alignment.path.size(); ++k) {
    const auto [row, column] = alignment.path[k];
    from_.push_back(turn_a + arc.length_a * row / intervals);
    to_.push_back(turn_b + arc.length_b * column / intervals);
  }
}

OutlineMap ArcsToMap::Map() && {
  from_.push_back(from_.front() + 1.0);
  to_.push_back(to_.front() + 1.0);
  return {std::move(from_), std::move(to_)};
}

}  // namespace posespace
