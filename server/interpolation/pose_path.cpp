// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/sparse_factor.h"

namespace posespace {
namespace {

constexpr Eigen::Index kMostPlaces = 1'000;
constexpr double kShortestLeg = 1e-3;  // seconds
constexpr double kLongest = 3'600.0;   // seconds
constexpr double kFarthest = 1e12;     // so that no square overflows

Error Invalid(std::string field, const std::string& description) {
  return ErrorAt(ErrorCode::kPathInvalid, std::move(field), description);
}

std::string WaypointField(Eigen::Index row, const char* field) {
  return "waypoints[" + std::to_string(row) + "]." + field;
}

Result<void> CheckPlaces(const Points& places) {
  if (places.rows() == 0) return Invalid("waypoints", "is empty");
  if (places.rows() > kMostPlaces) {
    return Invalid("waypoints", "has " + std::to_string(places.rows()) + " entries; at most " +
                                    std::to_string(kMostPlaces) + " are taken");
  }
  for (Eigen::Index k = 0; k < places.rows(); ++k) {
    if (places.row(k).allFinite() && places.row(k).cwiseAbs().maxCoeff() <= kFarthest) continue;
    return ErrorAt(ErrorCode::kPoseNotFinite, WaypointField(k, "at"),
                   "is not finite, or beyond 1e12");
  }
  return {};
}

// Knots of a path whose waypoints have times.
Result<std::vector<double>> KnotsFromTimes(const Waypoints& waypoints) {
  const std::vector<double>& times = waypoints.times;
  if (static_cast<Eigen::Index>(times.size()) != waypoints.places.rows()) {
    return Invalid("waypoints", "have times in some places and not in others");
  }
  if (waypoints.duration) return Invalid("duration", "is given beside the waypoints' times");
  std::vector<double> knots;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const std::string field = WaypointField(static_cast<Eigen::Index>(k), "time");
    if (!(times[k] >= 0.0 && times[k] <= kLongest)) {
      return Invalid(field, "is " + std::to_string(times[k]) + ", not 0 to 3600 seconds");
    }
    if (k > 0 && !(times[k] - times[k - 1] >= kShortestLeg)) {
      return Invalid(field, "is " + std::to_string(times[k]) + ", not a millisecond after " +
                                std::to_string(times[k - 1]) + ", the one before");
    }
    knots.push_back(times[k] - times.front());
  }
  if (waypoints.loop && knots.size() > 1) {
    knots.push_back(knots.back() + knots.back() / static_cast<double>(knots.size() - 1));
  }
  return knots;
}

// Knots of a path whose legs take time by their length.
Result<std::vector<double>> KnotsFromLengths(const Points& route, Eigen::Index waypoint_count,
                                             const std::optional<double>& duration) {
  if (duration && !(*duration > 0.0 && *duration <= kLongest)) {
    return Invalid("duration", "is " + std::to_string(*duration) +
                                   ", not more than 0 and at most 3600 seconds");
  }
  std::vector<double> knots{0.0};
  const Eigen::Index legs = route.rows() - 1;
  double length = 0.0;
  for (Eigen::Index k = 0; k < legs; ++k) length += (route.row(k + 1) - route.row(k)).norm();
  const double seconds = duration.value_or(static_cast<double>(legs));
  for (Eigen::Index k = 0; k < legs; ++k) {
    const double leg = seconds * ((route.row(k + 1) - route.row(k)).norm() / length);
    // Also refuses a length of zero, whose shares are not numbers.
    if (!(leg >= 1e-9 * seconds)) {
      return Invalid(WaypointField((k + 1) % waypoint_count, "at"),
                     "is where the waypoint before it is: give the waypoints times to rest there");
    }
    knots.push_back(knots.back() + leg);
  }
  return knots;
}

// Second derivatives at the knots of the C2 cubic through the places: zero at both ends, or
// periodic, where the last place is the first.  One row of the system a joint:
//   h_- M_- + 2 (h_- + h_+) M + h_+ M_+ = 6 (slope_+ - slope_-).
Result<Points> Curvatures(const std::vector<double>& knots, const Points& places, bool loop) {
  const Eigen::Index legs = places.rows() - 1;
  Points curvatures = Points::Zero(places.rows(), 2);
  const Eigen::Index first = loop ? 0 : 1;  // joints are the knots first .. legs - 1
  const Eigen::Index joints = legs - first;
  if (joints <= 0) return curvatures;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd jumps(joints, 2);
  const auto step = [&](Eigen::Index leg) {
    const auto k = static_cast<std::size_t>(leg);
    return knots[k + 1] - knots[k];
  };
  const auto slope = [&](Eigen::Index leg) -> Eigen::RowVector2d {
    return (places.row(leg + 1) - places.row(leg)) / step(leg);
  };
  for (Eigen::Index row = 0; row < joints; ++row) {
    const Eigen::Index after = row + first;
    const Eigen::Index before = after > 0 ? after - 1 : legs - 1;
    entries.emplace_back(row, row, 2.0 * (step(before) + step(after)));
    if (loop || row + 1 < joints) {
      const Eigen::Index next = (row + 1) % joints;
      entries.emplace_back(row, next, step(after));
      entries.emplace_back(next, row, step(after));
    }
    jumps.row(row) = 6.0 * (slope(after) - slope(before));
  }
  SparseFactor::Matrix matrix(joints, joints);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto factor = TRY(SparseFactor::Factor(matrix));
  curvatures.middleRows(first, joints) = factor.Solve(jumps);
  if (loop) curvatures.row(legs) = curvatures.row(0);
  return curvatures;
}

}  // namespace

Result<PosePath> PosePath::Fit(const Waypoints& waypoints) {
  TRY(CheckPlaces(waypoints.places));
  PosePath path;
  path.loop_ = waypoints.loop && waypoints.places.rows() > 1;
  path.easing_ = waypoints.easing;
  path.places_ = waypoints.places;
  if (path.loop_) {
    path.places_.conservativeResize(waypoints.places.rows() + 1, 2);
    path.places_.bottomRows<1>() = waypoints.places.topRows<1>();
  }
  path.knots_ =
      waypoints.times.empty()
          ? TRY(KnotsFromLengths(path.places_, waypoints.places.rows(), waypoints.duration))
          : TRY(KnotsFromTimes(waypoints));
  path.curvatures_ = TRY(Curvatures(path.knots_, path.places_, path.loop_));
  if (path.knots_.size() == 1 && waypoints.duration) {  // one place, and a time to rest there
    path.knots_.push_back(*waypoints.duration);
    path.places_ = path.places_.replicate(2, 1).eval();
    path.curvatures_ = Points::Zero(2, 2);
  }
  return path;
}

Point PosePath::At(double seconds) const {
  const double whole = duration();
  if (knots_.size() == 1) return places_.row(0);
  double share = seconds / whole;
  share = loop_ ? share - std::floor(share) : std::clamp(share, 0.0, 1.0);
  if (easing_ == Easing::kInOut) {
    share = share * share * share * (10.0 + share * (6.0 * share - 15.0));
  }
  const double time = share * whole;
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, time);
  const auto k = static_cast<Eigen::Index>(after - knots_.begin()) - 1;
  const double start = *(after - 1), step = *after - start;
  const double b = (time - start) / step, a = 1.0 - b;
  return a * places_.row(k) + b * places_.row(k + 1) +
         (step * step / 6.0) *
             ((a * a * a - a) * curvatures_.row(k) + (b * b * b - b) * curvatures_.row(k + 1));
}

}  // namespace posespace
