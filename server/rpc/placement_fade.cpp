// SPDX-License-Identifier: Apache-2.0
#include "rpc/placement_fade.h"

#include <algorithm>

namespace posespace {

void PlacementFade::Leave(const PoseWeights& left, Clock::time_point now) {
  if (length_ <= Clock::duration::zero()) return;
  if (left_.empty()) {
    left_.push_back({left, 1.0});
  } else if (progress_ > 0.0) {  // else nobody has seen anything of it
    for (Left& each : left_) each.share *= 1.0 - progress_;
    left_.push_back({left, progress_});
  }
  left_at_ = now;
  begun_.reset();
  progress_ = 0.0;
}

void PlacementFade::Stop() {
  left_.clear();
  begun_.reset();
  progress_ = 0.0;
}

void PlacementFade::Settle(Clock::time_point now) {
  if (begun_ ? now - *begun_ >= length_ : now - left_at_ >= kPatience) Stop();
}

void PlacementFade::Advance(Clock::time_point now) {
  if (!begun_) begun_ = now;
  const double passed = std::chrono::duration<double>(now - *begun_) / length_;
  if (passed >= 1.0) return Stop();
  const double x = std::max(0.0, passed);
  progress_ = x * x * (3.0 - 2.0 * x);
}

void PlacementFade::Mix(const Point& at, std::span<double> weights,
                        std::span<double> memory) const {
  for (double& weight : weights) weight *= progress_;
  for (const auto& [field, share] : left_) {
    field.At(at, memory);
    const double factor = (1.0 - progress_) * share;
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] += factor * memory[i];
  }
}

}  // namespace posespace
