// SPDX-License-Identifier: Apache-2.0
#include "mapping/common_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace posespace {
namespace {

constexpr double kMergeDistance = 0.0025;  // turns, on every outline
constexpr double kLeastGap = 1e-9;         // turns between rows; mapped rows closer are respaced

// A place that must become a row: a corner of one outline, or a landmark with its marks.
struct Stop {
  double common;                          // position in the common parameter
  int landmark;                           // or -1
  std::vector<std::pair<int, Mark>> own;  // drawings that have exactly this place, ascending
};

// One output row while its stops are collected.
struct Row {
  double first_common;
  double last_common;
  int landmark;
  std::vector<std::optional<Mark>> own;  // per drawing
};

// The corners of outline i in order from common position 0 on.  Corners that a landmark marks are
// left to the landmark.
void AppendCorners(int i, const OutlineCurve& curve, const OutlineMap& map,
                   std::span<const PlacedLandmark> landmarks, std::vector<Stop>& stops) {
  std::vector<double> marked;
  for (const PlacedLandmark& landmark : landmarks) {
    if (landmark.on[i]) marked.push_back(landmark.on[i]->position);
  }
  std::sort(marked.begin(), marked.end());

  const OutlineMap inverse = map.Inverse();
  const double begin = map.At(0.0);
  const auto turns_from_begin = [&](int k) {
    const double turns = curve.corner_position(k) - begin;
    return turns - std::floor(turns);
  };
  int first = 0;
  for (int k = 1; k < curve.num_corners(); ++k) {
    if (turns_from_begin(k) < turns_from_begin(first)) first = k;
  }
  double common = 0.0;
  for (int step = 0; step < curve.num_corners(); ++step) {
    const int k = (first + step) % curve.num_corners();
    const double position = curve.corner_position(k);
    // Rounding must not exchange corners.
    common = std::max(common, std::min(inverse.At(begin + turns_from_begin(k)), 1.0));
    if (std::binary_search(marked.begin(), marked.end(), position)) continue;
    stops.push_back({common, -1, {{i, Mark{position, curve.corner(k)}}}});
  }
}

// Sorted stops -> the same around the outline, so that the seam parts no stops that lie together.
void BeginAfterWidestGap(std::vector<Stop>& stops) {
  std::size_t first = 0;
  double widest = stops.front().common + 1.0 - stops.back().common;
  for (std::size_t k = 1; k < stops.size(); ++k) {
    const double gap = stops[k].common - stops[k - 1].common;
    if (gap <= widest) continue;
    widest = gap;
    first = k;
  }
  for (std::size_t k = 0; k < first; ++k) stops[k].common += 1.0;
  std::rotate(stops.begin(), stops.begin() + static_cast<std::ptrdiff_t>(first), stops.end());
}

bool CanShare(const Row& row, const Stop& stop, std::span<const OutlineMap> maps) {
  if (row.landmark >= 0 && stop.landmark >= 0) return false;
  for (const auto& [drawing, mark] : stop.own) {
    if (row.own[drawing]) return false;
  }
  return std::all_of(maps.begin(), maps.end(), [&](const OutlineMap& map) {
    return map.At(stop.common) - map.At(row.first_common) <= kMergeDistance;
  });
}

// Stops in common order -> rows; each row is a run of neighbouring stops.
std::vector<Row> CollectRows(const std::vector<Stop>& stops, std::span<const OutlineMap> maps) {
  std::vector<Row> rows;
  for (const Stop& stop : stops) {
    if (rows.empty() || !CanShare(rows.back(), stop, maps)) {
      rows.push_back({stop.common, stop.common, -1, {}});
      rows.back().own.resize(maps.size());
    }
    Row& row = rows.back();
    row.last_common = stop.common;
    row.landmark = std::max(row.landmark, stop.landmark);
    for (const auto& [drawing, mark] : stop.own) row.own[drawing] = mark;
  }
  return rows;
}

// Where the rows lie on outline i, rising over one turn.  Rows that came to lie on top of each
// other are spread evenly between the outline's own places around them, which are apart.
std::vector<double> PositionsOn(int i, const OutlineMap& map, const std::vector<Row>& rows) {
  std::vector<double> positions;
  std::vector<std::size_t> own;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double mapped = map.At(0.5 * (rows[r].first_common + rows[r].last_common));
    if (!rows[r].own[i]) {
      positions.push_back(mapped);
      continue;
    }
    const double position = rows[r].own[i]->position;
    positions.push_back(position + std::round(mapped - position));
    own.push_back(r);
  }
  const std::size_t n = rows.size();
  const auto at = [&](std::size_t r) { return positions[r % n] + (r >= n ? 1.0 : 0.0); };
  for (std::size_t k = 0; k < own.size(); ++k) {
    const std::size_t begin = own[k], end = k + 1 < own.size() ? own[k + 1] : own[0] + n;
    bool crowded = false;
    for (std::size_t r = begin; r < end; ++r) crowded |= !(at(r + 1) - at(r) > kLeastGap);
    if (!crowded) continue;
    const double from = at(begin), gap = (at(end) - from) / static_cast<double>(end - begin);
    for (std::size_t r = begin + 1; r < end; ++r) {
      positions[r % n] = from + gap * static_cast<double>(r - begin) - (r >= n ? 1.0 : 0.0);
    }
  }
  return positions;
}

}  // namespace

CommonRows ShareRows(std::span<const OutlineCurve> curves, std::span<const OutlineMap> maps,
                     std::span<const PlacedLandmark> landmarks) {
  std::vector<Stop> stops;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const double common = landmarks[l].common - std::floor(landmarks[l].common);
    Stop& stop = stops.emplace_back(Stop{common, static_cast<int>(l), {}});
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (landmarks[l].on[i]) stop.own.emplace_back(static_cast<int>(i), *landmarks[l].on[i]);
    }
  }
  for (std::size_t i = 0; i < curves.size(); ++i) {
    AppendCorners(static_cast<int>(i), curves[i], maps[i], landmarks, stops);
  }
  std::stable_sort(stops.begin(), stops.end(),
                   [](const Stop& a, const Stop& b) { return a.common < b.common; });
  BeginAfterWidestGap(stops);
  const std::vector<Row> rows = CollectRows(stops, maps);

  CommonRows result;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::vector<double> positions = PositionsOn(static_cast<int>(i), maps[i], rows);
    Points& outline = result.outlines.emplace_back(rows.size(), 2);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto& own = rows[r].own[i];
      outline.row(r) = (own ? own->point : curves[i].At(positions[r])).transpose();
    }
  }
  result.landmark_rows.resize(landmarks.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].landmark >= 0) result.landmark_rows[rows[r].landmark] = static_cast<int>(r);
  }
  return result;
}

}  // namespace posespace
