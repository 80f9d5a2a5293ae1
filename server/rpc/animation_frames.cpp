// SPDX-License-Identifier: Apache-2.0
#include "rpc/animation_frames.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "rpc/query_convert.h"

namespace posespace {
namespace {

constexpr double kDefaultFps = 60.0;
constexpr double kMostFps = 1'000.0;

Result<Easing> EasingFromProto(v1::Easing easing) {
  switch (easing) {
    case v1::EASING_UNSPECIFIED:
    case v1::EASING_UNIFORM:
      return Easing::kUniform;
    case v1::EASING_IN_OUT:
      return Easing::kInOut;
    default:
      return ErrorAt(ErrorCode::kInvalidOption, "path.easing",
                     "is " + std::to_string(easing) + ", which is not known here");
  }
}

Result<PosePath> PathFromProto(const v1::Path& path) {
  Waypoints waypoints;
  waypoints.places.resize(path.waypoints_size(), 2);
  for (int k = 0; k < path.waypoints_size(); ++k) {
    const v1::Waypoint& waypoint = path.waypoints(k);
    waypoints.places.row(k) << waypoint.at().x(), waypoint.at().y();
    if (waypoint.has_time()) waypoints.times.push_back(waypoint.time());
  }
  waypoints.loop = path.loop();
  waypoints.easing = TRY(EasingFromProto(path.easing()));
  if (path.has_duration()) waypoints.duration = path.duration();
  auto fitted = PosePath::Fit(waypoints);
  if (fitted) return fitted;
  return Under("path", std::move(fitted).error());
}

Result<int> CountFrames(const PosePath& path, double fps, int most) {
  // Half a millionth of a frame: an end that falls on a frame but for rounding is that frame.
  const double steps = std::ceil(path.duration() * fps - 5e-7);
  const double count = path.loop() ? std::max(1.0, steps) : steps + 1.0;
  if (count <= most) return static_cast<int>(count);
  return ErrorAt(ErrorCode::kTooManyFrames, "fps",
                 "makes " + std::to_string(static_cast<std::int64_t>(count)) +
                     " frames of this path; at most " + std::to_string(most) + " are taken");
}

}  // namespace

Result<AnimationFrames> AnimationFrames::Parse(const v1::Animation& animation, int most) {
  auto path = TRY(PathFromProto(animation.path()));
  const double fps = animation.has_fps() ? animation.fps() : kDefaultFps;
  if (!(fps > 0.0 && fps <= kMostFps)) {
    return ErrorAt(ErrorCode::kInvalidOption, "fps",
                   "is " + std::to_string(fps) + ", not more than 0 and at most 1000");
  }
  const int count = TRY(CountFrames(path, fps, most));
  v1::Query query;
  *query.mutable_options() = animation.options();
  query.mutable_at();
  return AnimationFrames(std::move(path), TRY(QueryFromProto(query)), fps, count);
}

Result<AnimationFrames> AnimationFrames::From(const v1::Animation& animation, int most) {
  auto frames = Parse(animation, most);
  if (frames) return frames;
  return Under("animation", std::move(frames).error());
}

double AnimationFrames::TimeOf(int frame) const {
  const double time = frame / fps_;
  return path_.loop() ? time : std::min(time, path_.duration());
}

Query AnimationFrames::At(int frame) const {
  Query query = query_;
  query.position = path_.At(TimeOf(frame));
  return query;
}

}  // namespace posespace
