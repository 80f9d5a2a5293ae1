// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_PLACEMENTS_H_
#define POSESPACE_SESSION_PLACEMENTS_H_

#include <map>
#include <span>
#include <string>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace posespace {

// shape id -> point of pose space.
using Placements = std::map<std::string, Point>;

// Where N drawings lie when nobody placed them: one at (0, 0), more on the unit circle, in the
// order of upload, pose k at angle 2 pi k / N from (1, 0).
Points DefaultPlacements(int count);

// Checks the places of drawings, row i that of drawing ids[i], as PoseWeights::Fit would refuse
// them, but by name and all at once, with fields "placements['walk']".
//
// Fails  kSizeMismatch, kPlacementNotFinite, kPlacementsCoincide (closer than a thousandth of the
//        greatest distance between two).
Result<void> CheckPlacements(std::span<const std::string> ids, const Points& places);

// Checks that exactly the drawings `ids` are placed.
// Fails  kShapeNotFound (a place for no drawing), kInvalidOption (a drawing without a place).
Result<void> CheckPlaced(std::span<const std::string> ids, const Placements& placements);

}  // namespace posespace

#endif  // POSESPACE_SESSION_PLACEMENTS_H_
