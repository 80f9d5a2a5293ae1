// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLACEMENT_FADE_H_
#define POSESPACE_RPC_PLACEMENT_FADE_H_

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "interpolation/pose_weights.h"

namespace posespace {

// The weights of a Play slot whose session has new placements: for a short time they go from those
// of the old weight field to those of the new one at the same point, smoothly (a smoothstep of
// time), so that avatars glide where they would jump.
//
// It begins with the first frame that is asked for, not with the change: that frame is exactly what
// was seen before, however late it comes.  Placements that change again meanwhile begin it anew
// from the mix that was seen last.
//
// All fields are of the same poses.  Weights of one time sum to one as those of each field do.
// Time is what the caller says it is.  One per slot, by one thread at a time; the fields are shared
// with everybody.
class PlacementFade {
 public:
  using Clock = std::chrono::steady_clock;

  // Fields that are left at a time, at most: each costs every weight one more evaluation.
  static constexpr std::size_t kMostLeft = 4;

  // A field that was left is kept so long for a first frame: who asks for what has moved alone
  // hears of the change within a second or so, and then asks.
  static constexpr std::chrono::seconds kPatience{10};

  // No length: every change is at once.
  explicit PlacementFade(Clock::duration length) : length_(length) {}

  // True until it has arrived: frames are to be mixed.
  bool running() const { return !left_.empty(); }

  // True when a field more could not be left without a jump: that change has to wait until this is
  // over.
  bool full() const { return left_.size() == kMostLeft; }

  // From here on on its way from what was seen last, of which `left` was the target.
  // Requires  not full().
  void Leave(const PoseWeights& left, Clock::time_point now);

  // Arrives at once.
  void Stop();

  // Ends what is over, or what nobody asks for.
  void Settle(Clock::time_point now);

  // The time of the frames that are mixed next, which begins it if nothing has.
  void Advance(Clock::time_point now);

  // Mixes what the fields that were left say at a point into the weights that the new one says
  // there.  `memory` has their size.
  void Mix(const Point& at, std::span<double> weights, std::span<double> memory) const;

 private:
  struct Left {
    PoseWeights field;
    double share;  // of the mix that was seen last; they sum to 1
  };

  Clock::duration length_;
  std::vector<Left> left_;
  Clock::time_point left_at_;
  std::optional<Clock::time_point> begun_;
  double progress_ = 0.0;  // share of the new field, at the time of the last frame
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PLACEMENT_FADE_H_
