// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLAY_TICK_H_
#define POSESPACE_RPC_PLAY_TICK_H_

#include <span>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/message_bytes.h"
#include "rpc/placement_fade.h"
#include "session/pose_space.h"

namespace posespace {

// What an item of a tick asks.
struct TickItem {
  const PoseSpace* pose_space = nullptr;  // null: its slot has no session
  const PlacementFade* fade = nullptr;    // null: none runs
  bool superseded = false;
};

// Answers a tick: items of one pose space with equal options are blended together, in memory that
// the thread keeps, straight into the message that travels.  In the steady state nothing is
// allocated for items that ask for a point of pose space and no weights.
//
// What is wrong with an item is in its answer.
// Requires  an item for each of the tick's, at most as many as a stream may ask for.
MessageBytes AnswerTick(const v1::PlayRequest::Tick& tick, std::span<const TickItem> items);

}  // namespace posespace

#endif  // POSESPACE_RPC_PLAY_TICK_H_
