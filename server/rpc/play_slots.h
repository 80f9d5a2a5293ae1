// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLAY_SLOTS_H_
#define POSESPACE_RPC_PLAY_SLOTS_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/result.h"
#include "posespace/v1/pose_service.pb.h"
#include "rpc/message_bytes.h"
#include "rpc/placement_fade.h"
#include "rpc/play_tick.h"
#include "session/registry.h"

namespace posespace {

// Which sessions a Play stream has bound to its slots, and what it answers to each message.  It
// knows no gRPC; what is waiting, in flight or ending is play_stream.h.  One per stream; one call
// at a time.
//
// A slot keeps its pose space until the session has a newer one: results of one message are of one
// revision, and RevisionChanged comes between two messages.  To a pose space of the same mesh at
// other placements its frames come over smoothly (placement_fade.h); when these change so fast that
// too many fields would be mixed, the newest waits for the end of that.
class PlaySlots {
 public:
  using Clock = PlacementFade::Clock;
  using Now = std::function<Clock::time_point()>;

  // Takes the answers, in order.
  using Send = std::function<void(MessageBytes)>;

  PlaySlots(const Registry& registry, const Limits& limits, Now now = &Clock::now);

  // Slot and tag of items, sorted.
  using Tags = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  // Answers one message; items of `superseded` are not blended.  What is wrong with a slot or an
  // item is in the answer; kProtocolBreach ends the stream.
  Result<void> Answer(const v1::PlayRequest& request, const Tags& superseded, const Send& send);

  // Moves every slot to its session's newest revision and says which have changed.
  void FollowRevisions(const Send& send);

  // About how long Answer takes, in microseconds.
  double EstimateMicroseconds(const v1::PlayRequest& request) const;

  // True when Answer will wait for a session that is not in memory.  One that is stays there until
  // the answer.
  bool MustLoad(const v1::PlayRequest& request);

 private:
  struct Slot {
    std::shared_ptr<Session> session = {};
    std::shared_ptr<const PoseSpace> pose_space = {};
    bool pinned = false;
    PlacementFade fade;
  };

  Result<Slot> Find(const v1::PlayRequest::Bind& bind);
  void Bind(const v1::PlayRequest::Bind& bind, const Send& send);
  bool Move(Slot* slot, std::shared_ptr<const PoseSpace> to);
  Result<void> Tick(const v1::PlayRequest::Tick& tick, const Tags& superseded, const Send& send);

  const Registry& registry_;
  const Limits limits_;
  const Now now_;
  std::map<std::uint32_t, Slot> slots_;
  std::vector<TickItem> items_;          // of the tick being answered
  std::shared_ptr<Session> next_bound_;  // the session of the next message, when it is a bind
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PLAY_SLOTS_H_
