// SPDX-License-Identifier: Apache-2.0
#include "geometry/progress.h"

#include <algorithm>

namespace posespace {

Progress::Progress(Progress* parent, double begin, double end) : parent_(parent) {
  if (parent == nullptr) return;
  listener_ = [parent, begin, end](std::string_view stage, double fraction) {
    parent->EnterStage(stage, begin + (end - begin) * fraction, end);
  };
}

void Progress::EnterStage(std::string_view stage, double begin, double end) {
  stage_ = stage;
  begin_ = begin;
  end_ = end;
  Report(0.0);
}

void Progress::Report(double fraction) {
  const double overall = begin_ + (end_ - begin_) * std::clamp(fraction, 0.0, 1.0);
  overall_ = std::max(overall_, overall);
  if (listener_) listener_(stage_, overall_);
}

}  // namespace posespace
