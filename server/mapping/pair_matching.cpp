// SPDX-License-Identifier: Apache-2.0
#include "mapping/pair_matching.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mapping/elastic_alignment.h"

namespace posespace {
namespace {

constexpr int kCoarseSamples = 64;
constexpr int kMiddleSamples = 128;
constexpr int kFineSamples = 256;
constexpr int kRefinement = 4;     // the last pass has this many samples for each fine one
constexpr int kBandSamples = 2;    // fine samples either side that the last pass may move
constexpr int kCoarseMaxStep = 3;  // slopes from 1/3 to 3
constexpr int kFineMaxStep = 6;    // slopes from 1/6 to 6
constexpr int kStartsKept = 3;
constexpr int kRecuts = 2;
constexpr double kLeastRecut = 0.25;  // turns from the old cut to the new
constexpr int kTurnColumns = 4;       // columns 0, 2, 4, 6 of the features
constexpr double kStartTie = 1.15;    // costs within this ratio do not tell starts apart

Alignment AlignArc(const OutlineCurve& a, const OutlineCurve& b, const Arc& arc, int intervals,
                   int max_step, const PairWeights& weights) {
  const Unlikeness unlikeness =
      SquaredDistances(FeaturesOf(a, Samples(arc.begin.on_a, arc.length_a, intervals), weights),
                       FeaturesOf(b, Samples(arc.begin.on_b, arc.length_b, intervals), weights));
  return ElasticProgramme(max_step, weights.stretch).Align(WholeBlock(unlikeness, intervals));
}

// The alignment again with more samples, near the given path.
Alignment Refine(const OutlineCurve& a, const OutlineCurve& b, const Arc& arc,
                 const Alignment& alignment, int intervals, const PairWeights& weights) {
  const int fine = kRefinement * intervals;
  const Eigen::MatrixXd features_a =
      FeaturesOf(a, Samples(arc.begin.on_a, arc.length_a, fine), weights);
  const Eigen::MatrixXd features_b =
      FeaturesOf(b, Samples(arc.begin.on_b, arc.length_b, fine), weights);

  AlignmentBand band{fine, nullptr, 0, std::vector<int>(fine + 1), 0};
  band.width = std::min(2 * kRefinement * kBandSamples, fine) + 1;
  band.stride = band.width;
  for (std::size_t k = 1; k < alignment.path.size(); ++k) {
    const auto [row, column] = alignment.path[k - 1];
    const auto [next_row, next_column] = alignment.path[k];
    for (int i = kRefinement * row; i <= kRefinement * next_row; ++i) {
      const double share = (i - kRefinement * row) / (double(kRefinement) * (next_row - row));
      const double centre = kRefinement * (column + share * (next_column - column));
      band.low[i] = std::clamp(static_cast<int>(std::lround(centre)) - band.width / 2, 0,
                               fine + 1 - band.width);
    }
  }
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(fine + 1) * band.width);
  for (int i = 0; i <= fine; ++i) {
    for (int j = band.low[i]; j < band.low[i] + band.width; ++j) {
      values.push_back((features_a.row(i) - features_b.row(j)).squaredNorm());
    }
  }
  band.values = values.data();
  return ElasticProgramme(kFineMaxStep, weights.stretch).Align(band);
}

struct Match {
  double cost;
  OutlineMap map;
};

Match MatchArcs(const OutlineCurve& a, const OutlineCurve& b, const std::vector<Anchor>& anchors,
                int samples, int max_step, bool refine, const PairWeights& weights) {
  double cost = 0.0;
  ArcsToMap map;
  for (const Arc& arc : ArcsBetween(anchors)) {
    int intervals = IntervalsOf(arc, samples);
    Alignment alignment = AlignArc(a, b, arc, intervals, max_step, weights);
    if (refine) {
      alignment = Refine(a, b, arc, alignment, intervals, weights);
      intervals *= kRefinement;
    }
    cost += 0.5 * (arc.length_a + arc.length_b) * alignment.cost;
    map.Append(arc, alignment, intervals);
  }
  return {cost, std::move(map).Map()};
}

// The pair of places on the map where both outlines turn most, away from the cut.
Anchor MostSalient(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map) {
  const Eigen::MatrixXd features_a = a.Features(map.from(), 0.0);
  const Eigen::MatrixXd features_b = b.Features(map.to(), 0.0);
  const auto salience = [](const auto& row) {
    double sum = 0.0;
    for (int k = 0; k < kTurnColumns; ++k) sum += row[2 * k] * row[2 * k];
    return sum;
  };
  double most = -1.0;
  std::size_t best = 0;
  for (std::size_t k = 0; k < map.from().size(); ++k) {
    const double turns = map.from()[k] - map.from().front();
    if (turns < kLeastRecut || turns > 1.0 - kLeastRecut) continue;
    const double both = std::min(salience(features_a.row(k)), salience(features_b.row(k)));
    if (both > most) {
      most = both;
      best = k;
    }
  }
  return {map.from()[best], map.to()[best]};
}

// Mean squared distance of matched places from their centroids' point of view, no rotation.
double PositionDifference(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map) {
  const Eigen::MatrixXd places_a = a.Features(map.from(), 1.0).rightCols<2>();
  const Eigen::MatrixXd places_b = b.Features(map.to(), 1.0).rightCols<2>();
  return (places_a - places_b).rowwise().squaredNorm().mean();
}

// The likeliest places of b where a may begin: the least of the local minima over all shifts.
std::vector<int> LikeliestShifts(const std::vector<double>& costs) {
  const int m = static_cast<int>(costs.size());
  std::vector<int> minima;
  for (int s = 0; s < m; ++s) {
    if (costs[s] < costs[(s + m - 1) % m] && costs[s] <= costs[(s + 1) % m]) minima.push_back(s);
  }
  if (minima.empty()) minima.push_back(0);
  std::stable_sort(minima.begin(), minima.end(), [&](int s, int t) { return costs[s] < costs[t]; });
  if (minima.size() > kStartsKept) minima.resize(kStartsKept);
  return minima;
}

}  // namespace

CoarseMatch MatchCoarsely(const OutlineCurve& a, const OutlineCurve& b,
                          const std::vector<Anchor>& anchors, const PairWeights& weights) {
  constexpr int m = kCoarseSamples;
  if (!anchors.empty()) {
    Match match = MatchArcs(a, b, anchors, m, kCoarseMaxStep, false, weights);
    return {match.cost, std::move(match.map), {}};
  }
  // Two turns of b, so that each shift is a block of one matrix.
  const Unlikeness unlikeness = SquaredDistances(FeaturesOf(a, Samples(0.0, 1.0, m), weights),
                                                 FeaturesOf(b, Samples(0.0, 2.0, 2 * m), weights));
  const ElasticProgramme programme(kCoarseMaxStep, weights.stretch);
  std::vector<double> costs(m);
  for (int s = 0; s < m; ++s) costs[s] = programme.Cost(WholeBlock(unlikeness, m, s));

  const std::vector<int> shifts = LikeliestShifts(costs);
  const Alignment alignment = programme.Align(WholeBlock(unlikeness, m, shifts[0]));
  const Anchor start{0.0, static_cast<double>(shifts[0]) / m};
  ArcsToMap map;
  map.Append({start, 1.0, 1.0}, alignment, m);
  std::vector<double> starts;
  for (const int s : shifts) starts.push_back(static_cast<double>(s) / m);
  return {alignment.cost, std::move(map).Map(), std::move(starts)};
}

OutlineMap MatchFrom(const OutlineCurve& a, const OutlineCurve& b, double start,
                     const PairWeights& weights) {
  return MatchArcs(a, b, {{0.0, start}}, kMiddleSamples, kFineMaxStep, false, weights).map;
}

FineMatch MatchFinely(const OutlineCurve& a, const OutlineCurve& b,
                      const std::vector<Anchor>& anchors, const std::vector<double>& starts,
                      const PairWeights& weights) {
  const auto match_from = [&](const std::vector<Anchor>& through, bool refine) {
    return MatchArcs(a, b, through, kFineSamples, kFineMaxStep, refine, weights);
  };
  if (!anchors.empty()) {
    Match match = match_from(anchors, true);
    return {match.cost, std::move(match.map)};
  }

  std::vector<Match> matches;
  for (const double start : starts) {
    Match match = match_from({{0.0, start}}, false);
    for (int pass = 0; pass < kRecuts; ++pass) {
      match = match_from({MostSalient(a, b, match.map)}, false);
    }
    matches.push_back(std::move(match));
  }
  auto best = std::min_element(matches.begin(), matches.end(),
                               [](const auto& x, const auto& y) { return x.cost < y.cost; });
  if (weights.position <= 0.0) {
    // Nothing else tells a freely rotated drawing's symmetric starts apart.
    const double limit = kStartTie * best->cost;
    double least = std::numeric_limits<double>::infinity();
    for (auto match = matches.begin(); match != matches.end(); ++match) {
      const double difference = PositionDifference(a, b, match->map);
      if (match->cost > limit || difference >= least) continue;
      least = difference;
      best = match;
    }
  }
  Match refined = match_from({MostSalient(a, b, best->map)}, true);
  return {refined.cost, std::move(refined.map)};
}

double MeanColourDifference(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map) {
  return (a.Colours(map.from()) - b.Colours(map.to())).rowwise().norm().mean();
}

}  // namespace posespace
