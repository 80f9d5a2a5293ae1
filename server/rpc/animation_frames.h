// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_ANIMATION_FRAMES_H_
#define POSESPACE_RPC_ANIMATION_FRAMES_H_

#include <utility>

#include "geometry/result.h"
#include "interpolation/pose_path.h"
#include "posespace/v1/pose_service.pb.h"
#include "session/pose_space.h"

namespace posespace {

// An animation as a row of queries: frame k lies k / fps seconds from the start.  The last frame of
// a path that is not looped is its end exactly, so up to a frame's time nearer to the one before
// it; a loop ends one frame before it repeats.  Immutable; pure.
class AnimationFrames {
 public:
  // Fields in errors begin with "animation.".
  // Fails  as PosePath::Fit and QueryFromProto; kInvalidOption (fps, easing), kTooManyFrames.
  static Result<AnimationFrames> From(const v1::Animation& animation, int most);

  int count() const { return count_; }
  double TimeOf(int frame) const;  // seconds from the start
  Query At(int frame) const;

 private:
  static Result<AnimationFrames> Parse(const v1::Animation& animation, int most);
  AnimationFrames(PosePath path, Query query, double fps, int count)
      : path_(std::move(path)), query_(std::move(query)), fps_(fps), count_(count) {}

  PosePath path_;
  Query query_;  // of every frame, but for its place
  double fps_;
  int count_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_ANIMATION_FRAMES_H_
