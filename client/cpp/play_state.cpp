// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/play_state.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "client/cpp/convert.h"
#include "client/cpp/transport_error.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using internal::Clock;
using internal::FrameItems;
using internal::Stream;

constexpr auto kKeeping = 250ms;  // between two looks at an idle stream
constexpr auto kGoodbye = 200ms;  // for the service to end the stream
constexpr Clock::duration kFirstPause = 20ms, kLongestPause = 1s;  // between tries to open it

// What opening the stream anew may mend.
bool MayPass(const Error& error) {
  return error.code() == ErrorCode::kUnavailable || error.retry_after();
}

// What no service of ours says.
Error Nonsense() { return Error(ErrorCode::kInternal, "the service's answer makes no sense"); }

}  // namespace

Player::State::State(std::shared_ptr<internal::Channel> channel, const std::string& session_id,
                     const std::string& revision)
    : channel_(std::move(channel)) {
  Open(Clock::now() + channel_->timeout(), /*again=*/false);
  Bind(session_id, revision);
  keeper_ = std::jthread([this](const std::stop_token& stop) {
    while (internal::Sleep(kKeeping, stop)) {
      const std::unique_lock lock(mutex_, std::try_to_lock);
      while (lock && stream_ && Step(Clock::now())) {
      }
    }
  });
}

Player::State::~State() {
  keeper_ = {};
  if (!stream_) return;
  stream_->WritesDone();
  const auto give_up = Clock::now() + kGoodbye;
  while (stream_->Next(give_up) == Stream::Event::kMessage) {
  }
}

// Slots.

std::uint32_t Player::State::Bind(const std::string& session_id, const std::string& revision) {
  const std::scoped_lock lock(mutex_);
  WaitUntil([this] { return stream_ && sent_.empty() && to_send_.empty(); });
  const auto free = std::find(slots_.begin(), slots_.end(), std::nullopt);
  const auto slot = static_cast<std::uint32_t>(free - slots_.begin());
  if (free == slots_.end()) slots_.emplace_back();
  slots_[slot] = Slot{session_id, revision, nullptr, {}};
  SayBind(slot);
  try {
    WaitUntil([this] { return stream_ && sent_.empty(); });
    if (slots_[slot]->refusal) throw Error(*slots_[slot]->refusal);
  } catch (const Error&) {
    slots_[slot].reset();
    throw;
  }
  return slot;
}

void Player::State::Unbind(std::uint32_t slot) {
  const std::scoped_lock lock(mutex_);
  if (slot >= slots_.size() || !slots_[slot]) return;
  WaitUntil([this] { return sent_.empty() && to_send_.empty(); });
  slots_[slot].reset();
  if (!stream_) return;
  v1::PlayRequest request;
  request.mutable_unbind()->set_slot(slot);
  stream_->Write(request);
}

BoundSession Player::State::Bound(std::uint32_t slot) const {
  const std::scoped_lock lock(mutex_);
  if (const Session bound = BoundAt(slot)) return *bound;
  throw Error(ErrorCode::kNotBuilt, "slot " + std::to_string(slot) + " has no session",
              "SLOT_NOT_BOUND");
}

Player::State::Session Player::State::BoundAt(std::uint32_t slot) const {
  return slot < slots_.size() && slots_[slot] ? slots_[slot]->bound : nullptr;
}

// Asking.  Messages are filled in place, since clearing them would free what they hold.

void Player::State::Ask(std::uint32_t slot, std::uint32_t tag, Point at,
                        const BlendOptions& options) {
  const std::scoped_lock lock(mutex_);
  internal::ToMessage(at, options, Gather(slot, tag, nullptr));
}

void Player::State::Ask(std::uint32_t slot, std::uint32_t tag, std::span<const double> weights,
                        const BlendOptions& options) {
  const std::scoped_lock lock(mutex_);
  internal::ToMessage(weights, options, Gather(slot, tag, BoundAt(slot)));
}

v1::Query* Player::State::Gather(std::uint32_t slot, std::uint32_t tag, Session meant_for) {
  if (gathered_.empty() || gathered_.back()->items >= std::max(1, status_.max_items)) {
    if (spare_messages_.empty()) spare_messages_.push_back(std::make_unique<Message>());
    gathered_.push_back(std::move(spare_messages_.back()));
    spare_messages_.pop_back();
    gathered_.back()->items = 0;
    gathered_.back()->meant_for.clear();
  }
  Message& message = *gathered_.back();
  auto& items = *message.request.mutable_tick()->mutable_items();
  v1::PlayRequest::Item* const item =
      message.items < items.size() ? items.Mutable(message.items) : items.Add();
  ++message.items;
  message.meant_for.push_back(std::move(meant_for));
  item->set_slot(slot);
  item->set_tag(tag);
  return item->mutable_query();
}

void Player::State::set_with_weights(bool with_weights) {
  const std::scoped_lock lock(mutex_);
  with_weights_ = with_weights;
}

void Player::State::set_compact(bool compact) {
  const std::scoped_lock lock(mutex_);
  compact_ = compact;
}

void Player::State::Send() {
  const std::scoped_lock lock(mutex_);
  if (spare_ticks_.empty()) spare_ticks_.push_back(std::make_unique<Tick>());
  ticks_.push_back(std::move(spare_ticks_.back()));
  spare_ticks_.pop_back();
  Tick& tick = *ticks_.back();
  tick.unanswered = gathered_.size();
  for (auto& message : gathered_) {
    v1::PlayRequest::Tick& request = *message->request.mutable_tick();
    while (request.items_size() > message->items) request.mutable_items()->RemoveLast();
    request.set_frame_id(next_frame_id_++);
    request.set_with_weights(with_weights_);
    request.set_vertex_format(compact_ ? v1::VERTEX_FORMAT_INT16 : v1::VERTEX_FORMAT_UNSPECIFIED);
    message->tick = &tick;
    to_send_.push_back(std::move(message));
  }
  gathered_.clear();
  Advance();
  if (stream_ && stream_->writing()) Step(Clock::now());
}

std::span<const Answer> Player::State::Receive() {
  const std::scoped_lock lock(mutex_);
  if (ticks_.empty()) {
    throw Error(ErrorCode::kInvalidArgument, "no tick is under way: Send comes before Receive");
  }
  WaitUntil([this] { return ticks_.front()->unanswered == 0; });
  if (received_) Recycle(std::move(received_));
  received_ = std::move(ticks_.front());
  ticks_.erase(ticks_.begin());
  Tick& tick = *received_;
  const std::span<const float> vertices(tick.items.vertices);
  const std::span<const double> numbers(tick.items.numbers.data(),
                                        static_cast<std::size_t>(tick.items.numbers.size()));
  const auto part = [](auto all, auto begin, auto end) {
    return all.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  };
  for (std::size_t k = 0; k < tick.answers.size(); ++k) {
    Answer& answer = tick.answers[k];
    if (answer.error != nullptr) continue;
    const FrameItems::Item& item = tick.items.items[k];
    answer.folds = item.folds;
    answer.mended = item.mended;
    answer.fading = item.fading;
    answer.vertices = part(vertices, item.vertices_begin, item.vertices_end);
    answer.weights = part(numbers, item.weights_begin, item.weights_end);
    answer.texture_weights = part(numbers, item.textures_begin, item.textures_end);
  }
  return tick.answers;
}

Player::State::Status Player::State::status() const {
  const std::scoped_lock lock(mutex_);
  Status status = status_;
  status.under_way = ticks_.size();
  return status;
}

// Waiting.

void Player::State::WaitUntil(const std::function<bool()>& done) {
  const auto give_up = Clock::now() + channel_->timeout();
  while (!done()) {
    if (!stream_) {
      Open(give_up, /*again=*/true);
    } else if (!Step(give_up)) {
      Fail(TooLate());
    }
  }
}

void Player::State::Open(Clock::time_point give_up, bool again) {
  if (lost_ && !MayPass(*lost_)) Fail(*lost_);
  Clock::duration pause = kFirstPause;
  for (;;) {
    OpenOnce(give_up);
    if (stream_) return;
    const bool pass = again ? MayPass(*lost_) : lost_->retry_after().has_value();
    if (!pass || Clock::now() + pause >= give_up) Fail(*lost_);
    internal::Sleep(pause, {});
    pause = std::min(2 * pause, kLongestPause);
  }
}

// Says what the new stream has to know, and then what the lost one has not answered.
void Player::State::OpenOnce(Clock::time_point give_up) {
  stream_ = channel_->Open(*v1::PlayRequest::descriptor());
  status_.draining = false;
  status_.max_items = 0;
  const auto settle = [&](const std::function<bool()>& done) {
    while (stream_ && !done()) {
      if (!Step(give_up)) Lose(TooLate());
    }
  };
  settle([this] { return status_.max_items > 0; });
  for (std::uint32_t slot = 0; stream_ && slot < slots_.size(); ++slot) {
    if (slots_[slot]) SayBind(slot);
  }
  settle([this] { return sent_.empty(); });
  if (!stream_) return;
  ready_ = true;
  ++status_.times_opened;
  Advance();
}

// Nobody here cancels a stream: that is a service that cuts off what it still has.
Error Player::State::EndOf(const Stream& stream) const {
  if (stream.error() && stream.error()->code() != ErrorCode::kCancelled) return *stream.error();
  return Error(ErrorCode::kUnavailable,
               "the service at " + channel_->address() + " has ended the stream",
               status_.draining ? "DRAINING" : "");
}

Error Player::State::TooLate() const {
  return internal::NoAnswer(channel_->address(),
                            std::chrono::duration<double>(channel_->timeout()).count());
}

void Player::State::Fail(Error error) {
  Lose(error);
  lost_.reset();
  for (auto& message : to_send_) spare_messages_.push_back(std::move(message));
  to_send_.clear();
  for (auto& tick : ticks_) Recycle(std::move(tick));
  ticks_.clear();
  throw Error(std::move(error));
}

// Events.

bool Player::State::Step(Clock::time_point deadline) {
  switch (stream_->Next(deadline)) {
    case Stream::Event::kNothing:
      return false;
    case Stream::Event::kMessage:
      Take();
      break;
    case Stream::Event::kEnded:
      Lose(EndOf(*stream_));
      break;
  }
  Advance();
  return true;
}

void Player::State::Take() {
  FrameItems nowhere;
  Tick* const tick = sent_.empty() ? nullptr : sent_.front()->tick;
  std::uint64_t frame_id = 0;
  switch (internal::ReadFrameResult(stream_->message().get(), &frame_id,
                                    tick != nullptr ? &tick->items : &nowhere)) {
    case internal::ReadOutcome::kFrameResult:
      return tick != nullptr ? TakeFrame(frame_id) : Lose(Nonsense());
    case internal::ReadOutcome::kBroken:
      return Lose(Nonsense());
    case internal::ReadOutcome::kAnotherMessage:
      break;
  }
  if (!response_.ParseFromZeroCopyStream(stream_->message().get())) return Lose(Nonsense());
  switch (response_.message_case()) {
    case v1::PlayResponse::kWelcome:
      status_.max_slots = static_cast<int>(response_.welcome().max_slots());
      status_.max_items = std::max(1, static_cast<int>(response_.welcome().max_items()));
      status_.max_in_flight = std::max(1, static_cast<int>(response_.welcome().max_in_flight()));
      return;
    case v1::PlayResponse::kBound:
      return TakeBound(response_.bound());
    case v1::PlayResponse::kRevisionChanged: {
      const auto& changed = response_.revision_changed();
      return Follow(changed.slot(), changed.revision(), changed.vertex_count(),
                    changed.shape_ids());
    }
    case v1::PlayResponse::kDraining:
      status_.draining = true;
      return;
    default:  // a sign of life
      return;
  }
}

void Player::State::TakeFrame(std::uint64_t frame_id) {
  std::unique_ptr<Message> message = std::move(sent_.front());
  sent_.erase(sent_.begin());
  Tick& tick = *message->tick;
  const std::size_t first = tick.answers.size();
  const std::size_t count = tick.items.count - first;
  if (message->request.tick().frame_id() != frame_id || count != message->meant_for.size()) {
    return Lose(Nonsense());
  }
  for (std::size_t k = 0; k < count; ++k) {
    const FrameItems::Item& item = tick.items.items[first + k];
    const Session& bound = tick.sessions.emplace_back(BoundAt(item.slot));
    Answer& answer = tick.answers.emplace_back();
    answer.slot = item.slot;
    answer.tag = item.tag;
    answer.session = bound.get();
    answer.error = ErrorOf(item, message->meant_for[k], &tick);
  }
  --tick.unanswered;
  spare_messages_.push_back(std::move(message));
}

// Why an item has no frame; null when it has one.
const Error* Player::State::ErrorOf(const FrameItems::Item& item, const Session& meant_for,
                                    Tick* tick) const {
  const Session bound = BoundAt(item.slot);
  if (meant_for && bound && !bound->revision.empty() && meant_for->shape_ids != bound->shape_ids) {
    return &tick->errors.emplace_back(ErrorCode::kConflict,
                                      "session '" + bound->session_id +
                                          "' was built again from other drawings than the weights "
                                          "are for",
                                      "REVISION_NOT_FOUND");
  }
  if (item.reason.empty()) return nullptr;
  if (item.reason == "SLOT_NOT_BOUND" && bound && slots_[item.slot]->refusal) {
    return &tick->errors.emplace_back(*slots_[item.slot]->refusal);
  }
  return &tick->errors.emplace_back(internal::ErrorOfReason(item.reason, item.message));
}

void Player::State::SayBind(std::uint32_t slot) {
  auto message = std::make_unique<Message>();
  v1::PlayRequest::Bind& bind = *message->request.mutable_bind();
  bind.set_slot(slot);
  bind.set_session_id(slots_[slot]->session_id);
  bind.set_pinned_revision(slots_[slot]->pinned_revision);
  stream_->Write(message->request);
  sent_.push_back(std::move(message));
}

void Player::State::TakeBound(const v1::PlayResponse::Bound& bound) {
  const bool asked = !sent_.empty() && sent_.front()->request.has_bind();
  if (!asked || sent_.front()->request.bind().slot() != bound.slot()) return Lose(Nonsense());
  sent_.erase(sent_.begin());
  Follow(bound.slot(), bound.revision(), bound.vertex_count(), bound.shape_ids());
  if (!bound.reason().empty()) {
    slots_[bound.slot()]->refusal = internal::ErrorOfReason(bound.reason(), bound.error_message());
  }
}

void Player::State::Follow(std::uint32_t slot, const std::string& revision, int vertex_count,
                           const google::protobuf::RepeatedPtrField<std::string>& shape_ids) {
  if (slot >= slots_.size() || !slots_[slot]) return;
  const std::string& session_id = slots_[slot]->session_id;
  slots_[slot]->bound = std::make_shared<BoundSession>(
      BoundSession{session_id, revision, vertex_count, {shape_ids.begin(), shape_ids.end()}});
  slots_[slot]->refusal.reset();
  if (revision.empty()) {
    slots_[slot]->refusal = Error(ErrorCode::kNotFound, "session '" + session_id + "' was deleted",
                                  "SESSION_NOT_FOUND");
  }
}

// Binds are said anew on the next stream, from the slots.
void Player::State::Lose(Error error) {
  lost_ = std::move(error);
  stream_.reset();
  ready_ = said_all_ = false;
  std::erase_if(sent_, [](const auto& message) { return message->tick == nullptr; });
  to_send_.insert(to_send_.begin(), std::make_move_iterator(sent_.begin()),
                  std::make_move_iterator(sent_.end()));
  sent_.clear();
}

// Sends what may be sent.  To a service that ends it says the last word as soon as that owes
// nothing.
void Player::State::Advance() {
  if (!stream_ || !ready_) return;
  if (status_.draining) {
    if (sent_.empty() && !said_all_) stream_->WritesDone();
    said_all_ = said_all_ || sent_.empty();
    return;
  }
  const auto may_be_sent = static_cast<std::size_t>(status_.max_in_flight);
  std::size_t count = 0;
  while (count < to_send_.size() && sent_.size() < may_be_sent) {
    stream_->Write(to_send_[count]->request);
    sent_.push_back(std::move(to_send_[count++]));
  }
  to_send_.erase(to_send_.begin(), to_send_.begin() + static_cast<std::ptrdiff_t>(count));
}

void Player::State::Recycle(std::unique_ptr<Tick> tick) {
  tick->items.Clear();
  tick->answers.clear();
  tick->sessions.clear();
  tick->errors.clear();
  spare_ticks_.push_back(std::move(tick));
}

}  // namespace posespace
