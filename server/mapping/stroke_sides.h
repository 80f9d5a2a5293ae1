// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_STROKE_SIDES_H_
#define POSESPACE_MAPPING_STROKE_SIDES_H_

#include <optional>
#include <vector>

#include "mapping/outline_curve.h"

namespace posespace {

// Which position of an outline lies across from which where the drawing is a thin stroke: nearer
// than 3 % of the perimeter through the inside, and running the other way.  Immutable; share
// freely.
//
// Cost  O(M^2) to make, with M = 512 samples.
class StrokeSides {
 public:
  explicit StrokeSides(const OutlineCurve& curve);

  // How much of the outline has a position across, 0 to 1.
  double share() const { return share_; }

  // The position across from `position`, in [0, 1); none at tips and where the drawing is not thin.
  std::optional<double> Across(double position) const;

 private:
  std::vector<double> across_;  // by sample; NaN: none
  double share_ = 0.0;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_STROKE_SIDES_H_
