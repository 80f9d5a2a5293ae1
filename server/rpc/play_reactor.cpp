// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_reactor.h"

#include <utility>

namespace posespace {

PlayReactor::PlayReactor(const Registry& registry, LiveStreams& streams, ComputePool& blends,
                         ComputePool& loads)
    : streams_(streams),
      blends_(blends),
      loads_(loads),
      stream_(registry, registry.limits(), *this) {
  auto admitted = streams_.Add(this);
  admitted_ = admitted.has_value();
  if (admitted_) {
    stream_.Start();
  } else {
    Finish(std::move(admitted));
  }
}

void PlayReactor::OnCancel() {
  if (admitted_) stream_.OnCancelled();
}

void PlayReactor::OnDone() {
  if (admitted_) streams_.Remove(this);
  delete this;
}

}  // namespace posespace
