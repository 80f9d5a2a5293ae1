// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_PLAYER_H_
#define POSESPACE_PLAYER_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "posespace/error.h"
#include "posespace/options.h"

namespace posespace {

class Session;

namespace internal {
class Channel;
}  // namespace internal

// What a slot of a Player has bound, as of one revision.
struct BoundSession {
  std::string session_id;
  std::string revision;  // empty once the session was deleted
  int vertex_count = 0;
  std::vector<std::string> shape_ids;  // in the order of weights
};

// The answer to one Player::Ask.
struct Answer {
  std::uint32_t slot = 0;           // as asked
  std::uint32_t tag = 0;            // as asked
  std::span<const float> vertices;  // x0 y0 x1 y1 ..., drawing pixels; empty with an error
  std::span<const double> weights;  // in the order of session->shape_ids; if asked for
  std::span<const double> texture_weights;
  int folds = 0;                          // triangles that are not positive; 0 in a good frame
  int mended = 0;                         // triangles that repair made positive
  bool fading = false;                    // placements have changed: ask again, it moves on
  const BoundSession* session = nullptr;  // what it is of; null when the slot has none
  const Error* error = nullptr;           // why there is no frame
};

// The stream of frames that avatar servers live on.  A tick's avatars travel in one message, and
// several ticks may be under way.
//
//   posespace::Player player = session.Play();              // the session is slot 0
//   const std::uint32_t cats = player.Bind(cat_session);    // any number of avatars share a slot
//   for (;;) {                                              // each tick
//     for (const Avatar& avatar : avatars) player.Ask(avatar.slot, avatar.index, avatar.place);
//     for (const posespace::Answer& answer : player.Tick()) {
//       if (answer.error == nullptr) Show(avatars[answer.tag], answer.vertices);
//     }
//   }
//
// Tick is Send and Receive.  To compute while the service does, Send tick k + 1 before receiving
// tick k.
//
// New placements of a session, with the same mesh, do not make its avatars jump: answers at points
// come over to them within 150 ms (unless the service was told otherwise) of the first one that is
// asked for, and say `fading` meanwhile.  Who asks only for avatars that have moved, asks again for
// those, too.
//
// One avatar's mistake stays in its answer.  When the connection breaks or the service drains, the
// next call that waits opens the stream again (through a load balancer: elsewhere), binds its
// sessions again and asks again for what had no answer, all within the client's timeout.  When that
// fails it throws Error, the ticks under way are dropped, and the Player can still be used: the
// next call tries anew.  A session that the service no longer has answers kNotFound to each of its
// items.
//
// One thread at a time.  A thread of its own looks after the stream four times a second while
// nobody calls, so that an idle Player follows rebuilds and does not hold up a service that ends.
// Memory is reused: at a steady rate of avatars nothing is allocated for an item here.
class Player {
 public:
  Player(Player&&) noexcept;
  Player& operator=(Player&&) noexcept;
  ~Player();  // what is under way is lost

  // Limits of the stream, as the service says: sessions bound, avatars in one message (more are
  // split over several), messages answered at once.
  int max_slots() const;
  int max_items() const;
  int max_in_flight() const;

  // Adds a session and answers its slot, the lowest that is free.  Waits for ticks under way, whose
  // answers stay to be received.  With `revision` results stay with that built pose space.
  // Throws kNotFound, kNotBuilt, kInvalidArgument (SLOT_LIMIT).
  std::uint32_t Bind(const Session& session, const std::string& revision = {});

  // Frees a slot.  Waits as Bind does.
  void Unbind(std::uint32_t slot);

  // What a slot has bound now; it follows rebuilds.  Throws kNotBuilt (SLOT_NOT_BOUND).
  BoundSession Bound(std::uint32_t slot) const;

  // Gathers an avatar for the next Send.  `tag` is the caller's own mark of the avatar.
  void Ask(std::uint32_t slot, std::uint32_t tag, Point at, const BlendOptions& options = {});

  // The same at explicit weights, in the order of Bound(slot).shape_ids.  Weights that a rebuild
  // from other drawings overtakes are answered with kConflict.
  void Ask(std::uint32_t slot, std::uint32_t tag, std::span<const double> weights,
           const BlendOptions& options = {});

  // Whether answers carry weights; not by default.  From the next Send on.
  void set_with_weights(bool with_weights);

  // Whether vertices travel as int16, in half the bytes, and are then off by at most 1/128,000 of
  // the longer side of the drawing's box; not by default.  From the next Send on.
  void set_compact(bool compact);

  // Sends what was gathered as one tick, and returns without waiting for its answer.  What exceeds
  // max_in_flight messages waits here and goes out as answers are received.
  void Send();

  // Waits for the oldest tick sent and answers it in the order it was asked; a tick of nothing is
  // answered with nothing.  The answers are good until the next Receive, Tick or destruction.
  // Throws kDeadlineExceeded when the service is silent for the client's timeout, kUnavailable when
  // it cannot be reached for that time, kInvalidArgument when nothing was sent.
  std::span<const Answer> Receive();

  // Send, then Receive until nothing is under way: the answers of the tick just sent.
  std::span<const Answer> Tick();

  // Ticks that were sent and not received.
  std::size_t under_way() const;

  // The service has said that it ends; until the stream is open elsewhere.
  bool draining() const;

  // How often the stream was opened: 1 until the first break.
  int times_opened() const;

 private:
  friend class Session;
  class State;
  Player(std::shared_ptr<internal::Channel> channel, const std::string& session_id,
         const std::string& revision);

  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_PLAYER_H_
