// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_reactor.h"

#include <random>
#include <utility>

namespace posespace {
namespace {

// When a stream that begins now is old.  Streams that began together do not end together.
PlayStream::Clock::time_point OldAt(std::chrono::seconds age) {
  static thread_local std::minstd_rand random(std::random_device{}());
  std::uniform_real_distribution<double> share(0.9, 1.1);
  return PlayStream::Clock::now() +
         std::chrono::duration_cast<PlayStream::Clock::duration>(share(random) * age);
}

}  // namespace

PlayReactor::PlayReactor(const Registry& registry, LiveStreams& streams, ComputePool& blends,
                         ComputePool& loads)
    : streams_(streams),
      blends_(blends),
      loads_(loads),
      stream_(registry, registry.limits(), *this, OldAt(registry.limits().max_stream_age)) {
  auto admitted = streams_.Add(this);
  admitted_ = admitted.has_value();
  if (admitted_) {
    stream_.Start();
  } else {
    Finish(std::move(admitted));
  }
}

void PlayReactor::StartWrite(MessageBytes message) {
  outgoing_ = std::move(message);
  ServerBidiReactor::StartWrite(&outgoing_);
}

void PlayReactor::OnCancel() {
  if (admitted_) stream_.OnCancelled();
}

void PlayReactor::OnDone() {
  if (admitted_) streams_.Remove(this);
  delete this;
}

}  // namespace posespace
