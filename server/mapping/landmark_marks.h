// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_LANDMARK_MARKS_H_
#define POSESPACE_MAPPING_LANDMARK_MARKS_H_

#include <optional>
#include <span>
#include <vector>

#include "geometry/result.h"
#include "mapping/boundary_matching.h"
#include "mapping/outline_curve.h"

namespace posespace {

// Where a landmark lies on one outline.
struct Mark {
  double position;  // as in outline_curve.h
  Point point;      // exactly the outline's point
};

// The user's landmarks on the outlines.  Landmarks that mark the same place are one.
struct Marks {
  std::vector<std::vector<std::optional<Mark>>> on;  // [landmark][drawing]
  std::vector<int> of_tuple;                         // the landmark that each tuple became
};

// Puts every mark on its outline and checks that the outlines can agree on a cyclic order.  All
// faults are reported at once, in `where`; the error's code is that of the first kind met, in the
// order below.
//
// Requires  as many curves as shapes, of the same outlines.
// Fails     kLandmarkNotFinite, kLandmarkOffOutline, kLandmarksOutOfOrder.
Result<Marks> PlaceLandmarks(std::span<const MatchingShape> shapes,
                             std::span<const OutlineCurve> curves,
                             std::span<const Landmark> landmarks, const MatchingOptions& options);

// A cyclic order of all landmarks that agrees with each drawing's own.  Where the drawings leave a
// choice, a landmark goes where `preferred` (a position per landmark) has it, if it can.  Nothing
// when there is no such order, or none within a bounded search.
std::optional<std::vector<int>> FindCommonOrder(const Marks& marks,
                                                std::span<const double> preferred);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_LANDMARK_MARKS_H_
