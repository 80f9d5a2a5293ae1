// SPDX-License-Identifier: Apache-2.0
#include "mapping/stroke_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace posespace {
namespace {

constexpr int kSamples = 512;
constexpr double kThin = 0.03;             // of the perimeter
constexpr double kDirectionReach = 0.004;  // turns either side, for the direction of the outline
constexpr double kOpposite = -0.7;         // cosine of directions that run the other way
constexpr double kLeastAround = 2.0;       // way along the outline / way across: less is a tip
constexpr double kContinuous = 0.02;       // turns; opposites of neighbours farther apart are not

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double TurnsBetween(double a, double b) { return std::abs(a - b - std::round(a - b)); }

// Where three values at -1, 0 and 1, the middle one least, have their minimum, within a half.
double MinimumBetween(double before, double here, double after) {
  const double bend = before - 2.0 * here + after;
  return bend > 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

StrokeSides::StrokeSides(const OutlineCurve& curve) : across_(kSamples, kNone) {
  Points places(kSamples, 2), directions(kSamples, 2);
  for (int k = 0; k < kSamples; ++k) {
    const double position = static_cast<double>(k) / kSamples;
    const Point ahead = curve.At(position + kDirectionReach);
    const Point behind = curve.At(position - kDirectionReach);
    places.row(k) = curve.At(position).transpose();
    directions.row(k) = (ahead - behind).normalized().transpose();
  }
  const auto distance = [&](int k, int j) {
    return (places.row((j + kSamples) % kSamples) - places.row(k)).norm();
  };
  for (int k = 0; k < kSamples; ++k) {
    double least = kThin * curve.perimeter();
    int nearest = -1;
    for (int j = 0; j < kSamples; ++j) {
      if (directions.row(k).dot(directions.row(j)) > kOpposite) continue;
      const Eigen::RowVector2d way = places.row(j) - places.row(k);
      const bool inward = directions(k, 0) * way.y() - directions(k, 1) * way.x() > 0.0;
      if (!inward || way.norm() >= least) continue;
      const double around =
          curve.perimeter() * TurnsBetween(double(j) / kSamples, double(k) / kSamples);
      if (around < kLeastAround * way.norm()) continue;
      least = way.norm();
      nearest = j;
    }
    if (nearest < 0) continue;
    const double offset = MinimumBetween(distance(k, nearest - 1), least, distance(k, nearest + 1));
    across_[k] = (nearest + offset) / kSamples;
    share_ += 1.0 / kSamples;
  }
}

std::optional<double> StrokeSides::Across(double position) const {
  const double sample = (position - std::floor(position)) * kSamples;
  const int k = static_cast<int>(sample) % kSamples;
  const double here = across_[k], next = across_[(k + 1) % kSamples];
  if (std::isnan(here) || std::isnan(next) || TurnsBetween(here, next) > kContinuous) return {};
  const double step = next - here - std::round(next - here);
  const double across = here + (sample - std::floor(sample)) * step;
  return across - std::floor(across);
}

}  // namespace posespace
