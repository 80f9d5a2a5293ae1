// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_stream.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace posespace {

PlayStream::PlayStream(const Registry& registry, const Limits& limits, PlayTransport& transport,
                       Clock::time_point old_at, PlaySlots::Now now)
    : transport_(transport),
      max_in_flight_(static_cast<std::size_t>(limits.max_in_flight)),
      old_at_(old_at),
      slots_(registry, limits, std::move(now)) {
  v1::PlayResponse welcome;
  welcome.mutable_welcome()->set_max_slots(static_cast<std::uint32_t>(limits.max_stream_slots));
  welcome.mutable_welcome()->set_max_items(static_cast<std::uint32_t>(limits.max_stream_items));
  welcome.mutable_welcome()->set_max_in_flight(static_cast<std::uint32_t>(limits.max_in_flight));
  Queue(MessageBytes(welcome));
}

void PlayStream::Start() {
  std::unique_lock lock(mutex_);
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::OnRead(bool ok) {
  std::unique_lock lock(mutex_);
  reading_ = false;
  if (!ok) {
    all_said_ = true;
  } else if (!outcome_) {
    waiting_.push_back(std::move(incoming_));
    ++in_flight_;
  }
  Next next = Advance(/*may_work_here=*/true);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::OnWritten(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  const Outgoing written = outgoing_.pop_front();
  if (written.completes) --in_flight_;
  queued_bytes_ -= written.bytes;
  if (!ok) {
    gone_ = true;
    End(Error{ErrorCode::kCancelled, "the client went away", {}});
  }
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::OnCancelled() {
  std::unique_lock lock(mutex_);
  gone_ = true;
  End(Error{ErrorCode::kCancelled, "the client went away", {}});
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::Work() {
  answers_.clear();
  superseded_.clear();
  const v1::PlayRequest* request = nullptr;  // stays in place while others are read
  {
    const std::scoped_lock lock(mutex_);
    request = &waiting_.front()->message();
    if (request->tick().latest_only()) FindSuperseded(&superseded_);
  }
  Result<void> answered = slots_.Answer(*request, superseded_, [this](MessageBytes answer) {
    answers_.push_back(std::move(answer));
  });

  std::unique_lock lock(mutex_);
  working_ = false;
  spare_.push_back(waiting_.pop_front());
  for (MessageBytes& answer : answers_) Queue(std::move(answer));
  if (answers_.empty() || gone_) {
    --in_flight_;
  } else {
    outgoing_.back().completes = true;
  }
  if (!answered) End(std::move(answered));
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::Beat(Clock::time_point now) {
  std::unique_lock lock(mutex_);
  if (now >= old_at_) StartDraining(kOldGrace, now);
  if (cut_off_ && now >= *cut_off_) End(Error{ErrorCode::kDraining, "the service has ended", {}});
  if (!working_ && !outcome_ && queued_bytes_ <= kQueuedBytes) {
    slots_.FollowRevisions([this](MessageBytes answer) { Queue(std::move(answer)); });
  }
  if (!outcome_ && outgoing_.empty() && now - last_said_ >= kHeartbeat) {
    v1::PlayResponse heartbeat;
    heartbeat.mutable_heartbeat();
    Queue(MessageBytes(heartbeat));
  }
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

void PlayStream::Drain(std::chrono::milliseconds stop_sending_in, Clock::time_point now) {
  std::unique_lock lock(mutex_);
  StartDraining(stop_sending_in, now);
  Next next = Advance(/*may_work_here=*/false);
  lock.unlock();
  Do(std::move(next));
}

// The first draining is said; a later one can only shorten it.
void PlayStream::StartDraining(std::chrono::milliseconds stop_sending_in, Clock::time_point now) {
  if (cut_off_) {
    cut_off_ = std::min(*cut_off_, now + stop_sending_in);
    return;
  }
  cut_off_ = now + stop_sending_in;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(stop_sending_in);
  v1::PlayResponse draining;
  auto* const duration = draining.mutable_draining()->mutable_stop_sending_in();
  duration->set_seconds(seconds.count());
  duration->set_nanos(
      static_cast<std::int32_t>(std::chrono::nanoseconds(stop_sending_in - seconds).count()));
  Queue(MessageBytes(draining));
}

// Items of the frames that wait behind the one to be answered.
void PlayStream::FindSuperseded(PlaySlots::Tags* tags) const {
  for (std::size_t k = 1; k < waiting_.size(); ++k) {
    for (const v1::PlayRequest::Item& item : waiting_[k]->message().tick().items()) {
      tags->emplace_back(item.slot(), item.tag());
    }
  }
  std::sort(tags->begin(), tags->end());
}

void PlayStream::Queue(MessageBytes message) {
  if (gone_) return;
  const std::size_t bytes = message.size();
  queued_bytes_ += bytes;
  outgoing_.push_back({std::move(message), bytes});
}

// The first outcome counts.  Messages that nobody works on yet are dropped, and once the client is
// gone so are answers, except one that is being written.
void PlayStream::End(Result<void> outcome) {
  if (finished_) return;
  if (!outcome_) outcome_ = std::move(outcome);
  waiting_.shorten(working_ ? 1 : 0);
  if (gone_) outgoing_.shorten(writing_ ? 1 : 0);
}

// Decides what happens next; the caller does it after unlocking.  Starting a write may send its
// bytes there and then, and the thread that hears of it would only wait for the lock.
PlayStream::Next PlayStream::Advance(bool may_work_here) {
  Next next;
  if (finished_) return next;
  if (!writing_ && !outgoing_.empty()) {
    writing_ = true;
    last_said_ = Clock::now();
    next.write = std::move(outgoing_.front().message);
  }
  if (!working_ && !waiting_.empty() && queued_bytes_ <= kQueuedBytes) {
    working_ = true;
    const v1::PlayRequest& request = waiting_.front()->message();
    const bool brief = slots_.EstimateMicroseconds(request) <= kShortWork;
    next.then = slots_.MustLoad(request) ? Then::kScheduleLoad
                : may_work_here && brief ? Then::kWorkHere
                                         : Then::kScheduleWork;
    // The answer is a moment away, and is written before the next message is read: reading first
    // would send the client its credit in a packet of its own.
    if (next.then == Then::kWorkHere) return next;
  }
  if (!reading_ && !all_said_ && !outcome_ && in_flight_ < max_in_flight_) {
    reading_ = true;
    if (!incoming_) TakeSpare();
    incoming_->Clear();
    next.read = &incoming_->message();
    starting_ += kStarting;
  }
  const bool over = outcome_ || (all_said_ && waiting_.empty());
  if (over && !working_ && !writing_ && outgoing_.empty() && MayFinish()) {
    finished_ = true;
    next.then = Then::kFinish;
  }
  return next;
}

// No read may follow a Finish: false when one is about to be started, whose starter then comes back
// for the Finish.
bool PlayStream::MayFinish() { return starting_.fetch_or(kFinishWaits) == 0; }

void PlayStream::TakeSpare() {
  if (spare_.empty()) spare_.push_back(std::make_unique<ReusedRequest>());
  incoming_ = std::move(spare_.back());
  spare_.pop_back();
}

// The stream may be gone after a call unless more is to be done here: what is yet to be started,
// worked on or finished keeps others from finishing.
void PlayStream::Do(Next next) {
  if (next.write) transport_.StartWrite(std::move(*next.write));
  if (next.read != nullptr) {
    transport_.StartRead(next.read);
    if (starting_.fetch_sub(kStarting) == (kStarting | kFinishWaits)) {
      std::unique_lock lock(mutex_);
      starting_ = 0;
      next = Advance(/*may_work_here=*/false);
      lock.unlock();
      return Do(std::move(next));
    }
  }
  switch (next.then) {
    case Then::kWait:
      return;
    case Then::kWorkHere:
      return Work();
    case Then::kScheduleWork:
      return transport_.ScheduleWork();
    case Then::kScheduleLoad:
      return transport_.ScheduleLoad();
    case Then::kFinish:
      return transport_.Finish(outcome_.value_or(Result<void>()));
  }
}

}  // namespace posespace
