// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_POSE_PATH_H_
#define POSESPACE_INTERPOLATION_POSE_PATH_H_

#include <optional>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"

namespace posespace {

// How a path is travelled.
enum class Easing {
  kUniform,  // as its times say
  kInOut,    // the path as a whole starts and ends at rest: time runs as 10 s^3 - 15 s^4 + 6 s^5
};

// What a path goes through, and when.
struct Waypoints {
  Points places;              // K x 2, points of pose space
  std::vector<double> times;  // K seconds, growing; or none: a leg takes time by its length
  bool loop = false;          // return to the first place, and go through it smoothly
  Easing easing = Easing::kUniform;
  std::optional<double> duration;  // seconds for all legs; only without times
};

// A curve through waypoints in pose space as a function of time: a cubic spline, so without a jump
// in velocity or acceleration (C2); natural at its ends, periodic when it is looped.
//
// A path of one place rests there.  Without times every leg takes its length's share of the
// duration, by default one second a leg; with times, a loop's way back takes the mean time of a
// leg.
//
// Immutable; share freely.
class PosePath {
 public:
  // Fails  kPathInvalid (none or more than 1,000 places; times that are not as many, not finite,
  // not
  //        growing by a millisecond; neighbours in one place without times; a duration beside
  //        times, not positive, or more than an hour), kPoseNotFinite (also beyond 1e12).  Fields
  //        are "waypoints[3].at", "waypoints[3].time", "duration".
  static Result<PosePath> Fit(const Waypoints& waypoints);

  // Seconds from start to end, a loop's way back included; 0 for one place without a duration.
  double duration() const { return knots_.back(); }
  bool loop() const { return loop_; }

  // Where the path is, seconds from its start.  Outside [0, duration] it rests at its ends; a loop
  // goes on and on.
  Point At(double seconds) const;

 private:
  PosePath() = default;

  std::vector<double> knots_;  // from 0; a loop's last is where it is back
  Points places_;              // one a knot
  Points curvatures_;          // second derivatives at the knots
  bool loop_ = false;
  Easing easing_ = Easing::kUniform;
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_POSE_PATH_H_
