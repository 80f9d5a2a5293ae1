// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_OUTLINE_MAP_H_
#define POSESPACE_MAPPING_OUTLINE_MAP_H_

#include <utility>
#include <vector>

namespace posespace {

// Which position of one outline is which of another (positions as in outline_curve.h): piecewise
// linear and strictly increasing, one turn to one turn.  Immutable; share freely.
class OutlineMap {
 public:
  OutlineMap() : OutlineMap({0.0, 1.0}, {0.0, 1.0}) {}  // each position goes to itself

  // Position from[k] goes to position to[k].  Both increase strictly, and each ends exactly one
  // turn after it begins.
  OutlineMap(std::vector<double> from, std::vector<double> to)
      : from_(std::move(from)), to_(std::move(to)) {}

  // At(s + 1) = At(s) + 1.
  double At(double position) const;

  OutlineMap Inverse() const { return {to_, from_}; }

  // First this map, then `next`.
  OutlineMap Then(const OutlineMap& next) const;

  const std::vector<double>& from() const { return from_; }
  const std::vector<double>& to() const { return to_; }

 private:
  std::vector<double> from_;
  std::vector<double> to_;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_OUTLINE_MAP_H_
