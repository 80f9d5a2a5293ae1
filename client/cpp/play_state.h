// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_PLAY_STATE_H_
#define POSESPACE_CLIENT_CPP_PLAY_STATE_H_

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "client/cpp/channel.h"
#include "client/cpp/frame_reader.h"
#include "client/cpp/stream.h"
#include "posespace/player.h"
#include "posespace/v1/pose_service.pb.h"

namespace posespace {

// What a Player does.  Its calls hold the lock; the keeper looks after the stream in between.
//
// The service answers one message after another, so what was sent is a queue whose front is
// answered next.  A frame is a pure function of what was asked, but while placements fade, so what
// a lost stream has not answered is asked again on the next one.
class Player::State {
 public:
  State(std::shared_ptr<internal::Channel> channel, const std::string& session_id,
        const std::string& revision);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::uint32_t Bind(const std::string& session_id, const std::string& revision);
  void Unbind(std::uint32_t slot);
  BoundSession Bound(std::uint32_t slot) const;

  void Ask(std::uint32_t slot, std::uint32_t tag, Point at, const BlendOptions& options);
  void Ask(std::uint32_t slot, std::uint32_t tag, std::span<const double> weights,
           const BlendOptions& options);
  void Send();
  std::span<const Answer> Receive();

  struct Status {
    int max_slots = 0;
    int max_items = 0;
    int max_in_flight = 0;
    std::size_t under_way = 0;
    bool draining = false;
    int times_opened = 0;
  };
  Status status() const;
  void set_with_weights(bool with_weights);
  void set_compact(bool compact);

 private:
  using Session = std::shared_ptr<const BoundSession>;

  struct Slot {
    std::string session_id;
    std::string pinned_revision;
    Session bound;
    std::optional<Error> refusal;  // why its items have no frames
  };

  // The answers to one Send, as they arrive.
  struct Tick {
    internal::FrameItems items;
    std::vector<Answer> answers;    // without their spans until all are here
    std::vector<Session> sessions;  // that the answers point to
    std::deque<Error> errors;       // that the answers point to
    std::size_t unanswered = 0;     // messages
  };

  // A message of a tick, or a Bind, which belongs to none.
  struct Message {
    v1::PlayRequest request;
    int items = 0;                   // that count; further ones are memory
    std::vector<Session> meant_for;  // by item: whose drawings its weights are for
    Tick* tick = nullptr;
  };
  using Messages = std::vector<std::unique_ptr<Message>>;

  v1::Query* Gather(std::uint32_t slot, std::uint32_t tag, Session meant_for);
  Session BoundAt(std::uint32_t slot) const;

  // Waiting.  These throw, after dropping what is under way.
  void WaitUntil(const std::function<bool()>& done);
  void Open(internal::Clock::time_point give_up, bool again);
  [[noreturn]] void Fail(Error error);
  Error TooLate() const;
  Error EndOf(const internal::Stream& stream) const;

  // Events.  These do not throw: what ends the stream is in lost_.
  void OpenOnce(internal::Clock::time_point give_up);
  bool Step(internal::Clock::time_point deadline);  // false: nothing happened
  void Take();
  void TakeFrame(std::uint64_t frame_id);
  void TakeBound(const v1::PlayResponse::Bound& bound);
  void Follow(std::uint32_t slot, const std::string& revision, int vertex_count,
              const google::protobuf::RepeatedPtrField<std::string>& shape_ids);
  void Lose(Error error);
  void Advance();
  void SayBind(std::uint32_t slot);

  const Error* ErrorOf(const internal::FrameItems::Item& item, const Session& meant_for,
                       Tick* tick) const;
  void Recycle(std::unique_ptr<Tick> tick);

  const std::shared_ptr<internal::Channel> channel_;
  mutable std::mutex mutex_;
  std::unique_ptr<internal::Stream> stream_;  // none while it is lost
  std::optional<Error> lost_;                 // why
  bool ready_ = false;                        // its sessions are bound
  bool said_all_ = false;
  v1::PlayResponse response_;
  Status status_;

  std::vector<std::optional<Slot>> slots_;
  Messages gathered_;
  Messages to_send_;
  Messages sent_;                             // the front is answered next
  std::vector<std::unique_ptr<Tick>> ticks_;  // under way, the oldest first
  std::unique_ptr<Tick> received_;            // whose answers the caller looks at
  std::uint64_t next_frame_id_ = 1;
  bool with_weights_ = false;
  bool compact_ = false;

  Messages spare_messages_;
  std::vector<std::unique_ptr<Tick>> spare_ticks_;

  std::jthread keeper_;  // the last member: it ends first
};

}  // namespace posespace

#endif  // POSESPACE_CLIENT_CPP_PLAY_STATE_H_
