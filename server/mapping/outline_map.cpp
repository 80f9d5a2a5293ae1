// SPDX-License-Identifier: Apache-2.0
#include "mapping/outline_map.h"

#include <algorithm>
#include <cmath>

namespace posespace {
namespace {

constexpr double kLeastKnotGap = 1e-12;  // turns; nearer knots of a composition are one

}  // namespace

double OutlineMap::At(double position) const {
  const double turns = std::floor(position - from_.front());
  const double within = std::clamp(position - turns, from_.front(), from_.back());
  const auto after = std::upper_bound(from_.begin() + 1, from_.end() - 1, within);
  const auto k = after - from_.begin();
  const double fraction = (within - from_[k - 1]) / (from_[k] - from_[k - 1]);
  return turns + to_[k - 1] + fraction * (to_[k] - to_[k - 1]);
}

OutlineMap OutlineMap::Then(const OutlineMap& next) const {
  // The knots are ours and, taken back to where we start, the next map's.
  const OutlineMap inverse = Inverse();
  std::vector<double> knots(from_.begin(), from_.end() - 1);
  for (auto knot = next.from_.begin(); knot + 1 != next.from_.end(); ++knot) {
    const double start = inverse.At(*knot);
    knots.push_back(start - std::floor(start - from_.front()));
  }
  std::sort(knots.begin(), knots.end());

  std::vector<double> from, to;
  const double begin = from_.front(), end = next.At(to_.front()) + 1.0;
  for (const double knot : knots) {
    const double image = next.At(At(knot));
    const bool apart =
        from.empty() || (knot - from.back() > kLeastKnotGap && image - to.back() > kLeastKnotGap);
    const bool before_end = begin + 1.0 - knot > kLeastKnotGap && end - image > kLeastKnotGap;
    if (!apart || !before_end) continue;
    from.push_back(knot);
    to.push_back(image);
  }
  from.push_back(from.front() + 1.0);
  to.push_back(to.front() + 1.0);
  return {std::move(from), std::move(to)};
}

}  // namespace posespace
