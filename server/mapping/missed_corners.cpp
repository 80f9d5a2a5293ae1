// SPDX-License-Identifier: Apache-2.0
#include "mapping/missed_corners.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/outline_curve.h"

namespace posespace {
namespace {

constexpr int kSamples = 1024;         // of a turn
constexpr double kArm = 0.006;         // turns, the sides of a corner
constexpr double kSharp = 0.8;         // radians that a sharp corner turns by, at least
constexpr double kStraight = 0.35;     // radians; a run that turns by less everywhere is straight
constexpr int kBeside = 10;            // samples either side of a place that must be straight
constexpr double kCounterpart = 0.06;  // turns from there to a corner that it may have missed
constexpr double kAlike = 0.5;         // radians between the turns of a corner and its counterpart
constexpr int kLeastMissed = 2;
// Of the sharp corners of the drawing that has fewer; well matched drawings miss up to 0.3.
constexpr double kLeastShare = 1.0 / 3.0;

struct Corner {
  double position;
  double turn;  // radians
};

// An outline with how it turns around it.
struct TurningOutline {
  explicit TurningOutline(const Points& outline) : curve(outline, {}) {
    for (int k = 0; k < kSamples; ++k) {
      const double position = static_cast<double>(k) / kSamples;
      const Point here = curve.At(position);
      const Point in = here - curve.At(position - kArm), out = curve.At(position + kArm) - here;
      turns.push_back(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out)));
    }
    const int arm = static_cast<int>(kArm * kSamples);
    for (int k = 0; k < kSamples; ++k) {
      const double size = std::abs(turns[k]);
      bool sharpest = size >= kSharp;
      for (int step = 1; sharpest && step <= arm; ++step) {
        sharpest = std::abs(At(k - step)) < size && std::abs(At(k + step)) <= size;
      }
      if (sharpest) corners.push_back({static_cast<double>(k) / kSamples, turns[k]});
    }
  }

  double At(int sample) const { return turns[((sample % kSamples) + kSamples) % kSamples]; }

  // Whether nothing about `position` turns the same way as the corner.
  bool MeetsStraight(const Corner& corner, double position) const {
    const int middle = static_cast<int>(std::lround(position * kSamples));
    for (int k = middle - kBeside; k <= middle + kBeside; ++k) {
      if (std::copysign(1.0, corner.turn) * At(k) >= kStraight) return false;
    }
    return true;
  }

  OutlineCurve curve;
  std::vector<double> turns;  // radians, by sample
  std::vector<Corner> corners;
};

struct Missed {
  int count = 0;
  Point on_a, on_b;  // the first of them and its counterpart
};

// The corners of a that meet a straight run of b beside a corner like them, which meets a straight
// run of a.
Missed MissedBy(const TurningOutline& a, const TurningOutline& b, const OutlineMap& to_b) {
  const OutlineMap to_a = to_b.Inverse();
  Missed missed;
  for (const Corner& corner : a.corners) {
    const double image = to_b.At(corner.position);
    if (!b.MeetsStraight(corner, image)) continue;
    const auto counterpart =
        std::find_if(b.corners.begin(), b.corners.end(), [&](const Corner& other) {
          const double apart = other.position - image - std::round(other.position - image);
          return std::abs(apart) < kCounterpart && std::abs(other.turn - corner.turn) < kAlike &&
                 a.MeetsStraight(other, to_a.At(other.position));
        });
    if (counterpart == b.corners.end()) continue;
    if (missed.count++ > 0) continue;
    missed.on_a = a.curve.At(corner.position);
    missed.on_b = b.curve.At(counterpart->position);
  }
  return missed;
}

}  // namespace

std::optional<MissedCorners> FindMissedCorners(std::span<const Points> outlines) {
  std::vector<TurningOutline> turning(outlines.begin(), outlines.end());
  const int n = static_cast<int>(turning.size());
  std::optional<MissedCorners> worst;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      const OutlineMap map = MapBetween(turning[i].curve, turning[j].curve);
      const Missed missed = MissedBy(turning[i], turning[j], map);
      const int count =
          std::min(missed.count, MissedBy(turning[j], turning[i], map.Inverse()).count);
      const auto corners = std::min(turning[i].corners.size(), turning[j].corners.size());
      if (count < kLeastMissed || count <= kLeastShare * static_cast<double>(corners)) continue;
      if (worst && count <= worst->count) continue;
      worst = MissedCorners{i, j, count, missed.on_a, missed.on_b};
    }
  }
  return worst;
}

}  // namespace posespace
