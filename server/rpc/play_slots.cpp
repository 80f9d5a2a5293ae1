// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_slots.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "rpc/query_convert.h"
#include "rpc/shown_error.h"

namespace posespace {
namespace {

constexpr std::size_t kMessageBytes = 512;

// Fills `reason` and `error_message` of an answer.
template <typename Answer>
void SetError(Error error, Answer* answer) {
  const Error shown = Shown(std::move(error));
  answer->set_reason(std::string(ReasonName(shown.code)));
  answer->set_error_message(CleanText(shown.message, kMessageBytes));
}

// Fills `revision`, `vertex_count` and `shape_ids`.
template <typename Answer>
void SetRevision(const PoseSpace& pose_space, Answer* answer) {
  answer->set_revision(pose_space.revision());
  answer->set_vertex_count(pose_space.mesh().num_vertices());
  for (const auto& drawing : pose_space.drawings()) answer->add_shape_ids(drawing->id);
}

// Whether the same weights are the same drawing in both.
bool BlendAlike(const PoseSpace& a, const PoseSpace& b) {
  return a.mesh_digest() == b.mesh_digest() && a.turns() == b.turns();
}

}  // namespace

PlaySlots::PlaySlots(const Registry& registry, const Limits& limits, Now now)
    : registry_(registry), limits_(limits), now_(std::move(now)) {}

Result<void> PlaySlots::Answer(const v1::PlayRequest& request, const Tags& superseded,
                               const Send& send) {
  switch (request.message_case()) {
    case v1::PlayRequest::kBind:
      Bind(request.bind(), send);
      return {};
    case v1::PlayRequest::kUnbind:
      slots_.erase(request.unbind().slot());
      return {};
    case v1::PlayRequest::kTick:
      FollowRevisions(send);
      return Tick(request.tick(), superseded, send);
    case v1::PlayRequest::MESSAGE_NOT_SET:
      break;
  }
  return Error{ErrorCode::kProtocolBreach, "a message without bind, unbind or tick", {}};
}

void PlaySlots::Bind(const v1::PlayRequest::Bind& bind, const Send& send) {
  v1::PlayResponse response;
  v1::PlayResponse::Bound* const bound = response.mutable_bound();
  bound->set_slot(bind.slot());
  slots_.erase(bind.slot());
  if (auto slot = Find(bind)) {
    SetRevision(*slot->pose_space, bound);
    slots_.emplace(bind.slot(), std::move(*slot));
  } else {
    SetError(std::move(slot).error(), bound);
  }
  send(MessageBytes(response));
}

Result<PlaySlots::Slot> PlaySlots::Find(const v1::PlayRequest::Bind& bind) {
  if (bind.slot() >= static_cast<std::uint32_t>(limits_.max_stream_slots)) {
    return Error{ErrorCode::kSlotLimit,
                 "slot " + std::to_string(bind.slot()) + " is not below " +
                     std::to_string(limits_.max_stream_slots),
                 {}};
  }
  Slot slot{.fade = PlacementFade(limits_.placement_fade)};
  slot.session = std::exchange(next_bound_, nullptr);
  if (slot.session == nullptr || slot.session->id() != bind.session_id()) {
    slot.session = TRY(registry_.Find(bind.session_id()));
  }
  slot.pose_space = TRY(slot.session->Built());
  slot.pinned = !bind.pinned_revision().empty();
  TRY(CheckRevision(*slot.pose_space, bind.pinned_revision()));
  return slot;
}

void PlaySlots::FollowRevisions(const Send& send) {
  for (auto entry = slots_.begin(); entry != slots_.end();) {
    auto& [number, slot] = *entry;
    if (slot.fade.running()) slot.fade.Settle(now_());
    const bool deleted = slot.session->closed();
    auto newest = slot.session->Built();
    const bool newer = !slot.pinned && newest && *newest != slot.pose_space;
    if (deleted || (newer && Move(&slot, std::move(*newest)))) {
      v1::PlayResponse response;
      response.mutable_revision_changed()->set_slot(number);
      if (!deleted) SetRevision(*slot.pose_space, response.mutable_revision_changed());
      send(MessageBytes(response));
    }
    entry = deleted ? slots_.erase(entry) : std::next(entry);
  }
}

// False when that has to wait.
bool PlaySlots::Move(Slot* slot, std::shared_ptr<const PoseSpace> to) {
  if (!BlendAlike(*slot->pose_space, *to)) {
    slot->fade.Stop();
  } else if (slot->fade.full()) {
    return false;
  } else {
    slot->fade.Leave(slot->pose_space->weight_field(), now_());
  }
  slot->pose_space = std::move(to);
  return true;
}

Result<void> PlaySlots::Tick(const v1::PlayRequest::Tick& tick, const Tags& superseded,
                             const Send& send) {
  if (tick.items_size() > limits_.max_stream_items) {
    return Error{ErrorCode::kProtocolBreach,
                 "frame " + std::to_string(tick.frame_id()) + " has " +
                     std::to_string(tick.items_size()) + " items; at most " +
                     std::to_string(limits_.max_stream_items) + " are taken",
                 {}};
  }
  items_.clear();
  std::optional<Clock::time_point> now;  // the same for all items
  for (const v1::PlayRequest::Item& item : tick.items()) {
    TickItem& answered = items_.emplace_back();
    answered.superseded = std::binary_search(superseded.begin(), superseded.end(),
                                             std::pair(item.slot(), item.tag()));
    const auto found = slots_.find(item.slot());
    if (found == slots_.end()) continue;
    Slot& slot = found->second;
    answered.pose_space = slot.pose_space.get();
    if (!slot.fade.running() || answered.superseded) continue;
    if (!now) now = now_();
    slot.fade.Advance(*now);
    if (slot.fade.running()) answered.fade = &slot.fade;
  }
  send(AnswerTick(tick, items_));
  return {};
}

bool PlaySlots::MustLoad(const v1::PlayRequest& request) {
  next_bound_ = nullptr;
  if (!request.has_bind()) return false;
  auto session = registry_.Peek(request.bind().session_id());
  if (!session) return false;
  next_bound_ = std::move(session).value();
  return next_bound_ == nullptr;
}

double PlaySlots::EstimateMicroseconds(const v1::PlayRequest& request) const {
  constexpr int kTogether = 6;  // that many items fill enough lanes
  const bool together = request.tick().items_size() >= kTogether;
  double sum = 0.0;
  for (const v1::PlayRequest::Item& item : request.tick().items()) {
    const auto slot = slots_.find(item.slot());
    if (slot == slots_.end()) continue;
    sum += posespace::EstimateMicroseconds(*slot->second.pose_space, item.query(),
                                           /*weights_only=*/false, together);
  }
  return sum;
}

}  // namespace posespace
