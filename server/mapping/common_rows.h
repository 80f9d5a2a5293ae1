// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_COMMON_ROWS_H_
#define POSESPACE_MAPPING_COMMON_ROWS_H_

#include <optional>
#include <span>
#include <vector>

#include "mapping/landmark_marks.h"
#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"

namespace posespace {

// A landmark with a place on every outline.
struct PlacedLandmark {
  double common;                        // its common position
  std::vector<std::optional<Mark>> on;  // what the user marked, per drawing
};

struct CommonRows {
  std::vector<Points> outlines;    // as in MatchedOutlines
  std::vector<int> landmark_rows;  // of each placed landmark
};

// Turns outlines with a common parameter into outlines with common rows: one for every landmark and
// for every corner of every outline, except that neighbouring corners of different outlines share
// a row when they lie closer than 0.25 % of the perimeter on all of them.  A shared row is on each
// of those outlines its own corner, so every output ring passes through all its corners.
//
// maps[i] goes from the common parameter to positions on outline i.
//
// Requires  marks of different landmarks on one outline at different places, in the common order.
CommonRows ShareRows(std::span<const OutlineCurve> curves, std::span<const OutlineMap> maps,
                     std::span<const PlacedLandmark> landmarks);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_COMMON_ROWS_H_
