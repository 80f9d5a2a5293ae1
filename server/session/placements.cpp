// SPDX-License-Identifier: Apache-2.0
#include "session/placements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "session/ids.h"

namespace posespace {
namespace {

// Closer places than this, / diameter of the placements, coincide: the weight field could not tell
// the poses apart (PoseWeights::Fit).
constexpr double kClosest = 1e-3;

std::string FieldOf(const std::string& id) { return "placements[" + Quoted(id) + "]"; }

}  // namespace

Points DefaultPlacements(int count) {
  Points places = Points::Zero(count, 2);
  if (count == 1) return places;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    places.row(k) << std::cos(angle), std::sin(angle);
  }
  return places;
}

Result<void> CheckPlacements(std::span<const std::string> ids, const Points& places) {
  const auto count = static_cast<Eigen::Index>(ids.size());
  if (places.rows() != count) {
    return Error{
        ErrorCode::kSizeMismatch,
        std::to_string(places.rows()) + " placements for " + std::to_string(count) + " drawings",
        {}};
  }
  std::vector<Violation> where;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!places.row(i).allFinite()) {
      where.push_back(
          {FieldOf(ids[i]) + ".at", "the place of shape " + Quoted(ids[i]) + " is not finite"});
    }
  }
  if (!where.empty()) {
    const std::string message = where.front().description;
    return Error{ErrorCode::kPlacementNotFinite, message, std::move(where)};
  }

  const auto distance = [&](Eigen::Index i, Eigen::Index j) {
    return std::hypot(places(i, 0) - places(j, 0), places(i, 1) - places(j, 1));
  };
  double diameter = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) diameter = std::max(diameter, distance(i, j));
  }
  if (!std::isfinite(diameter)) {
    return Error{
        ErrorCode::kPlacementNotFinite, "the placements are too far apart for numbers", {}};
  }
  const bool vanishes = diameter < std::numeric_limits<double>::min();
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (distance(i, j) >= kClosest * diameter && !vanishes) continue;
      where.push_back({FieldOf(ids[i]) + ".at", "shapes " + Quoted(ids[j]) + " and " +
                                                    Quoted(ids[i]) + " lie at the same place"});
    }
  }
  if (!where.empty()) {
    const std::string message = where.front().description +
                                ": places must differ by at least a thousandth of the farthest "
                                "distance between two";
    return Error{ErrorCode::kPlacementsCoincide, message, std::move(where)};
  }
  return {};
}

Result<void> CheckPlaced(std::span<const std::string> ids, const Placements& placements) {
  std::vector<Violation> where;
  for (const auto& [id, place] : placements) {
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
      where.push_back({FieldOf(id), "there is no shape " + Quoted(id)});
    }
  }
  if (!where.empty()) {
    const std::string message = where.front().description + " to place";
    return Error{ErrorCode::kShapeNotFound, message, std::move(where)};
  }
  for (const std::string& id : ids) {
    if (!placements.contains(id)) {
      where.push_back({FieldOf(id), "shape " + Quoted(id) + " has no place in pose space"});
    }
  }
  if (!where.empty()) {
    const std::string message =
        where.front().description + ": place every drawing, or none for places on the unit circle";
    return Error{ErrorCode::kInvalidOption, message, std::move(where)};
  }
  return {};
}

}  // namespace posespace
