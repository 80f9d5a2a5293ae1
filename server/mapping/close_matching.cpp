// SPDX-License-Identifier: Apache-2.0
#include "mapping/close_matching.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "mapping/elastic_alignment.h"

namespace posespace {
namespace {

constexpr int kSamples = 1024;  // of a turn
constexpr int kMaxStep = 6;     // slopes from 1/6 to 6
constexpr int kPasses = 3;
constexpr double kRecut = 0.382;  // turns from the cut of one pass to that of the next

// Weights beside those of the match before.  Directions are to decide: windows that span corners
// would stretch straight runs unevenly.  And where directions agree nowhere, as at limbs that the
// other drawing does not have, outlines must not be squeezed to nothing instead.
constexpr double kDirectionWeight = 2.0;  // of the squared difference of unit vectors
constexpr double kStiffness = 12.0;       // times the weight of stretching
constexpr double kArm = 0.004;            // turns either side, for the direction of the outline
constexpr double kReach = 0.06;           // turns that a place may move in a pass
constexpr int kRotationSamples = 256;
// How the drawings are turned onto each other: as a whole, by large parts, or by limbs.
struct Turning {
  double part;  // turns, the standard deviation of the window of a part's rotation; 0: the whole
  double tie;   // by how much it must cost less than what is coarser, beside kTie
};
constexpr Turning kTurnings[] = {{0.0, 0.0}, {0.06, 0.006}, {0.02, 0.035}};
// What the match may cost more when turned more coarsely: letters cost up to 1.15 times as much as
// a whole or too little to tell, swinging limbs 1.2 to 2 times, bent bars 4 and more.  By limbs
// letters cost less by up to 0.03, a figure whose arms go from hanging to raised by 0.05 to 0.13.
constexpr double kTie = 1.15;

constexpr double kStrokeShare = 0.5;  // of an outline that has a place across: then it is a stroke
constexpr double kSideReach = 0.016;  // turns that a side may move in a pass
constexpr double kSideLimit = 0.06;   // turns that the sides may have slipped
constexpr double kSidePull = 2400.0;  // unlikeness a squared turn of slip

// A direction or a rotation, of absolute value 1.
using Direction = std::complex<double>;

Direction Normalised(const Direction& sum) {
  const double length = std::abs(sum);
  return length > 0.0 ? sum / length : 1.0;
}

Direction DirectionAt(const OutlineCurve& curve, double position) {
  const Point along = curve.At(position + kArm) - curve.At(position - kArm);
  return Normalised({along.x(), along.y()});
}

// The rotations that turn places of a into their images' directions, sampled along a.
std::vector<Direction> RotationsOf(const OutlineCurve& a, const OutlineCurve& b,
                                   const OutlineMap& map) {
  std::vector<Direction> rotations;
  for (int k = 0; k < kRotationSamples; ++k) {
    const double position = static_cast<double>(k) / kRotationSamples;
    rotations.push_back(DirectionAt(b, map.At(position)) * std::conj(DirectionAt(a, position)));
  }
  return rotations;
}

std::vector<Direction> MeanRotation(const std::vector<Direction>& rotations) {
  Direction sum = 0.0;
  for (const Direction& rotation : rotations) sum += rotation;
  return std::vector<Direction>(rotations.size(), Normalised(sum));
}

std::vector<Direction> SmoothRotations(const std::vector<Direction>& rotations, double part) {
  const int n = static_cast<int>(rotations.size());
  std::vector<double> window;
  for (int k = 0; k < n; ++k) {
    const double turns = static_cast<double>(std::min(k, n - k)) / n / part;
    window.push_back(std::exp(-0.5 * turns * turns));
  }
  std::vector<Direction> smooth;
  for (int k = 0; k < n; ++k) {
    Direction sum = 0.0;
    for (int j = 0; j < n; ++j) sum += window[(j - k + n) % n] * rotations[j];
    smooth.push_back(Normalised(sum));
  }
  return smooth;
}

Direction RotationAt(const std::vector<Direction>& rotations, double position) {
  const double sample = (position - std::floor(position)) * static_cast<double>(rotations.size());
  const std::size_t k = static_cast<std::size_t>(sample) % rotations.size();
  const double share = sample - std::floor(sample);
  return Normalised((1.0 - share) * rotations[k] + share * rotations[(k + 1) % rotations.size()]);
}

void AppendDirections(const std::vector<Direction>& directions, Eigen::MatrixXd& features) {
  features.conservativeResize(Eigen::NoChange, features.cols() + 2);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const Direction weighted = std::sqrt(kDirectionWeight) * directions[k];
    features.row(static_cast<Eigen::Index>(k)).tail<2>() << weighted.real(), weighted.imag();
  }
}

struct CloseMatch {
  double cost;
  OutlineMap map;
};

// Matches two drawings closely, pass after pass.
class ClosePair {
 public:
  ClosePair(const OutlineCurve& a, const StrokeSides& sides_a, const OutlineCurve& b,
            const StrokeSides& sides_b, const std::vector<Anchor>& anchors,
            const PairWeights& weights)
      : a_(a),
        sides_a_(sides_a),
        b_(b),
        sides_b_(sides_b),
        anchors_(anchors),
        weights_(weights),
        programme_(kMaxStep, kStiffness * weights.stretch) {}

  // `keep_sides`: with each place of a thin stroke drawn towards the middle between its image and
  // the place across from the image of its opposite side.
  CloseMatch Match(OutlineMap map, const Turning& turning, bool keep_sides) const {
    double cost = 0.0;
    for (int pass = 0; pass < kPasses; ++pass) {
      std::vector<Anchor> through = anchors_;
      if (through.empty()) {
        // What one pass holds fixed the others mend.
        const double cut = map.from().front() + kRecut;
        through = {{cut, map.At(cut)}};
      }
      const auto rotations = RotationsOf(a_, b_, map);
      const auto smooth =
          turning.part == 0.0 ? MeanRotation(rotations) : SmoothRotations(rotations, turning.part);
      cost = 0.0;
      ArcsToMap next;
      for (const Arc& arc : ArcsBetween(through)) {
        const int intervals = IntervalsOf(arc, kSamples);
        const Alignment alignment = AlignNear(map, arc, intervals, smooth, keep_sides);
        cost += 0.5 * (arc.length_a + arc.length_b) * alignment.cost;
        next.Append(arc, alignment, intervals);
      }
      map = std::move(next).Map();
    }
    return {cost, std::move(map)};
  }

 private:
  Alignment AlignNear(const OutlineMap& map, const Arc& arc, int intervals,
                      const std::vector<Direction>& rotations, bool keep_sides) const {
    const std::vector<double> on_a = Samples(arc.begin.on_a, arc.length_a, intervals);
    const std::vector<double> on_b = Samples(arc.begin.on_b, arc.length_b, intervals);
    Eigen::MatrixXd features_a = FeaturesOf(a_, on_a, weights_);
    Eigen::MatrixXd features_b = FeaturesOf(b_, on_b, weights_);
    std::vector<Direction> directions_a, directions_b;
    for (const double position : on_a) {
      directions_a.push_back(DirectionAt(a_, position) * RotationAt(rotations, position));
    }
    for (const double position : on_b) directions_b.push_back(DirectionAt(b_, position));
    AppendDirections(directions_a, features_a);
    AppendDirections(directions_b, features_b);

    AlignmentBand band{intervals, nullptr, 0, std::vector<int>(intervals + 1), 0};
    const double reach = keep_sides ? kSideReach : kReach;
    band.width = std::min(2 * static_cast<int>(reach * kSamples), intervals) + 1;
    band.stride = band.width;
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(intervals + 1) * band.width);
    double before = on_b[0];
    for (int i = 0; i <= intervals; ++i) {
      double image = map.At(on_a[i]);
      image += std::round(before - image);
      if (i == intervals) image = on_b.back();
      before = image;
      const double column = (image - arc.begin.on_b) / arc.length_b * intervals;
      band.low[i] = std::clamp(static_cast<int>(std::lround(column)) - band.width / 2,
                               i == 0 ? 0 : band.low[i - 1], intervals + 1 - band.width);
      std::optional<double> target;
      if (keep_sides) target = BetweenSides(map, on_a[i], image);
      for (int j = band.low[i]; j < band.low[i] + band.width; ++j) {
        const double slip = target ? on_b[j] - *target : 0.0;
        values.push_back((features_a.row(i) - features_b.row(j)).squaredNorm() +
                         kSidePull * slip * slip);
      }
    }
    band.values = values.data();
    return programme_.Align(band);
  }

  // The middle between a place's image and the place across from that of its opposite side.
  std::optional<double> BetweenSides(const OutlineMap& map, double position, double image) const {
    const auto opposite = sides_a_.Across(position);
    if (!opposite) return {};
    const auto across = sides_b_.Across(map.At(*opposite));
    if (!across) return {};
    const double away = *across - image - std::round(*across - image);
    if (std::abs(away) >= kSideLimit) return {};
    return image + 0.5 * away;
  }

  const OutlineCurve& a_;
  const StrokeSides& sides_a_;
  const OutlineCurve& b_;
  const StrokeSides& sides_b_;
  const std::vector<Anchor>& anchors_;
  const PairWeights& weights_;
  const ElasticProgramme programme_;
};

}  // namespace

OutlineMap MatchClosely(const OutlineCurve& a, const StrokeSides& sides_a, const OutlineCurve& b,
                        const StrokeSides& sides_b, const std::vector<Anchor>& anchors,
                        const OutlineMap& map, const PairWeights& weights) {
  const ClosePair pair(a, sides_a, b, sides_b, anchors, weights);
  Turning turning = kTurnings[0];
  CloseMatch close = pair.Match(map, turning, false);
  for (const Turning& finer : std::span(kTurnings).subspan(1)) {
    CloseMatch by_parts = pair.Match(map, finer, false);
    if (close.cost < kTie * by_parts.cost + finer.tie) continue;
    close = std::move(by_parts);
    turning = finer;
  }
  if (std::min(sides_a.share(), sides_b.share()) < kStrokeShare) return close.map;
  return pair.Match(std::move(close.map), turning, true).map;
}

}  // namespace posespace
