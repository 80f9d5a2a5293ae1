// SPDX-License-Identifier: Apache-2.0
#include "mapping/matched_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/polygon.h"

namespace posespace {
namespace {

constexpr double kTurnWindow = 1.0 / 32;  // turns either side, over which an outline's turn counts
constexpr int kStartCandidates = 512;     // rows that may be the start, spread evenly

// Where the rows lie along all outlines together: turns from row 0, and 1 when it is reached again.
// Summed in an order of the outlines' own, so that the caller's decides nothing, not even rounding.
std::vector<double> MeanPositions(std::span<const Points> outlines) {
  std::vector<const Points*> sorted;
  for (const Points& outline : outlines) sorted.push_back(&outline);
  std::sort(sorted.begin(), sorted.end(), [](const Points* a, const Points* b) {
    return std::lexicographical_compare(a->data(), a->data() + a->size(), b->data(),
                                        b->data() + b->size());
  });

  const Eigen::Index n = outlines[0].rows();
  std::vector<double> positions(n + 1, 0.0);
  for (const Points* each : sorted) {
    const Points& outline = *each;
    const double share = 1.0 / (Perimeter(outline) * static_cast<double>(outlines.size()));
    double length = 0.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      length += (outline.row((k + 1) % n) - outline.row(k)).norm();
      positions[k + 1] += share * length;
    }
  }
  return positions;
}

// The point of `outline` at a mean position, any number of turns away.
Point PlaceAt(const Points& outline, const std::vector<double>& positions, double position) {
  position -= std::floor(position);
  const auto after = std::upper_bound(positions.begin() + 1, positions.end() - 1, position);
  const Eigen::Index k = after - positions.begin() - 1;
  const double length = positions[k + 1] - positions[k];
  const double share = length > 0.0 ? std::clamp((position - positions[k]) / length, 0.0, 1.0) : 0;
  const Eigen::Index next = (k + 1) % outline.rows();
  return (1.0 - share) * outline.row(k).transpose() + share * outline.row(next).transpose();
}

// How far all outlines turn there: the least of their turns.
double CommonTurn(std::span<const Points> outlines, const std::vector<double>& positions,
                  double position) {
  double least = std::numeric_limits<double>::infinity();
  for (const Points& outline : outlines) {
    const Point here = PlaceAt(outline, positions, position);
    const Point a = here - PlaceAt(outline, positions, position - kTurnWindow);
    const Point b = PlaceAt(outline, positions, position + kTurnWindow) - here;
    least = std::min(least, std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b))));
  }
  return least;
}

}  // namespace

std::vector<Points> SampleTogether(std::span<const Points> outlines, int count) {
  const std::vector<double> positions = MeanPositions(outlines);
  double start = 0.0, most = -1.0;
  for (int k = 0; k < kStartCandidates; ++k) {
    const double row = *std::lower_bound(positions.begin(), positions.end() - 1,
                                         static_cast<double>(k) / kStartCandidates);
    const double turn = CommonTurn(outlines, positions, row);
    if (turn <= most) continue;
    most = turn;
    start = row;
  }
  std::vector<Points> places;
  for (const Points& outline : outlines) {
    Points& points = places.emplace_back(count, 2);
    for (int k = 0; k < count; ++k) {
      points.row(k) =
          PlaceAt(outline, positions, start + static_cast<double>(k) / count).transpose();
    }
  }
  return places;
}

}  // namespace posespace
