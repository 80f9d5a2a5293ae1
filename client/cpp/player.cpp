// SPDX-License-Identifier: Apache-2.0
#include "posespace/player.h"

#include <utility>

#include "client/cpp/play_state.h"
#include "posespace/session.h"

namespace posespace {

Player::Player(std::shared_ptr<internal::Channel> channel, const std::string& session_id,
               const std::string& revision)
    : state_(std::make_unique<State>(std::move(channel), session_id, revision)) {}
Player::Player(Player&&) noexcept = default;
Player& Player::operator=(Player&&) noexcept = default;
Player::~Player() = default;

int Player::max_slots() const { return state_->status().max_slots; }
int Player::max_items() const { return state_->status().max_items; }
int Player::max_in_flight() const { return state_->status().max_in_flight; }
std::size_t Player::under_way() const { return state_->status().under_way; }
bool Player::draining() const { return state_->status().draining; }
int Player::times_opened() const { return state_->status().times_opened; }
void Player::set_with_weights(bool with_weights) { state_->set_with_weights(with_weights); }
void Player::set_compact(bool compact) { state_->set_compact(compact); }

std::uint32_t Player::Bind(const Session& session, const std::string& revision) {
  return state_->Bind(session.id(), revision);
}

void Player::Unbind(std::uint32_t slot) { state_->Unbind(slot); }
BoundSession Player::Bound(std::uint32_t slot) const { return state_->Bound(slot); }

void Player::Ask(std::uint32_t slot, std::uint32_t tag, Point at, const BlendOptions& options) {
  state_->Ask(slot, tag, at, options);
}

void Player::Ask(std::uint32_t slot, std::uint32_t tag, std::span<const double> weights,
                 const BlendOptions& options) {
  state_->Ask(slot, tag, weights, options);
}

void Player::Send() { state_->Send(); }
std::span<const Answer> Player::Receive() { return state_->Receive(); }

std::span<const Answer> Player::Tick() {
  state_->Send();
  while (state_->status().under_way > 1) state_->Receive();
  return state_->Receive();
}

}  // namespace posespace
