// SPDX-License-Identifier: Apache-2.0
#include "mapping/mirror_symmetry.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace posespace {
namespace {

constexpr int kSamples = 512;             // along an outline; so many sums are tried
constexpr double kMostDifference = 0.03;  // of an outline and its mirror image, of the radius
constexpr double kMostOff = 0.1;          // turns from the sum that a map means to a symmetry's
constexpr double kSameKnot = 1e-9;        // turns

double WithinHalfATurn(double turns) { return turns - std::round(turns); }

// A curve's samples as complex numbers about their mean, of mean square 1.
std::vector<std::complex<double>> Samples(const OutlineCurve& curve) {
  std::vector<std::complex<double>> samples;
  std::complex<double> mean = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const Point p = curve.At(static_cast<double>(k) / kSamples);
    samples.emplace_back(p.x(), p.y());
    mean += samples.back() / static_cast<double>(kSamples);
  }
  double square = 0.0;
  for (auto& sample : samples) {
    sample -= mean;
    square += std::norm(sample) / kSamples;
  }
  for (auto& sample : samples) sample /= std::sqrt(square);
  return samples;
}

// How alike the outline and its mirror image about the best axis are when positions that sum to
// `sum` samples go to each other: 1 when they are the same.
double Likeness(const std::vector<std::complex<double>>& samples, int sum) {
  std::complex<double> total = 0.0;
  for (int k = 0; k < kSamples; ++k) total += samples[k] * samples[(sum + kSamples - k) % kSamples];
  return std::abs(total) / kSamples;
}

// The sum on the second outline that the map's places mean, given one on the first, and how far
// they are from agreeing.
SymmetryPair MeantBy(const OutlineMap& map, double sum_a) {
  // The circular mean, then deviations from it.
  std::vector<double> sums;
  std::complex<double> direction = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double position = static_cast<double>(k) / kSamples;
    sums.push_back(map.At(position) + map.At(sum_a - position));
    direction += std::polar(1.0, 2.0 * std::numbers::pi * sums.back());
  }
  const double mean = std::arg(direction) / (2.0 * std::numbers::pi);
  double deviation = 0.0;
  for (const double sum : sums) deviation += std::abs(WithinHalfATurn(sum - mean)) / kSamples;
  return {sum_a, mean, deviation};
}

}  // namespace

std::vector<double> FindMirrorSums(const OutlineCurve& curve) {
  const auto samples = Samples(curve);
  std::vector<double> likeness(kSamples), sums;
  for (int sum = 0; sum < kSamples; ++sum) likeness[sum] = Likeness(samples, sum);
  for (int sum = 0; sum < kSamples; ++sum) {
    const double here = likeness[sum];
    // Of mean square 1 both, they differ by sqrt(2 (1 - likeness)).
    if (2.0 * (1.0 - here) > kMostDifference * kMostDifference) continue;
    const double before = likeness[(sum + kSamples - 1) % kSamples];
    const double after = likeness[(sum + 1) % kSamples];
    if (before >= here || after > here) continue;
    const double bend = before - 2.0 * here + after;
    const double place = (sum + 0.5 * (before - after) / bend) / kSamples;
    sums.push_back(place - std::floor(place));
  }
  std::sort(sums.begin(), sums.end());
  return sums;
}

std::optional<SymmetryPair> BestKeptSymmetry(const std::vector<double>& sums_a,
                                             const std::vector<double>& sums_b,
                                             const OutlineMap& map) {
  std::optional<SymmetryPair> best;
  if (sums_b.empty()) return best;
  for (const double sum_a : sums_a) {
    SymmetryPair pair = MeantBy(map, sum_a);
    const auto off = [&](double sum) { return std::abs(WithinHalfATurn(sum - pair.sum_b)); };
    const double nearest = *std::min_element(sums_b.begin(), sums_b.end(),
                                             [&](double x, double y) { return off(x) < off(y); });
    if (off(nearest) > kMostOff || (best && best->deviation <= pair.deviation)) continue;
    pair.sum_b = nearest;
    best = pair;
  }
  return best;
}

OutlineMap Symmetrised(const OutlineMap& map, const SymmetryPair& symmetry) {
  const double begin = map.from().front();
  std::vector<double> knots(map.from().begin(), map.from().end() - 1);
  for (auto knot = map.from().begin(); knot + 1 != map.from().end(); ++knot) {
    const double mirrored = symmetry.sum_a - *knot;
    knots.push_back(mirrored - std::floor(mirrored - begin));
  }
  std::sort(knots.begin(), knots.end());
  const auto mirrored = [&](double position) {
    return symmetry.sum_b - map.At(symmetry.sum_a - position);
  };
  double apart = 0.0;  // on average: both gain one turn a turn
  for (const double knot : knots) apart += mirrored(knot) - map.At(knot);
  const double turns = std::round(apart / static_cast<double>(knots.size()));
  std::vector<double> from, to;
  for (const double knot : knots) {
    if (!from.empty() && knot - from.back() < kSameKnot) continue;
    if (begin + 1.0 - knot < kSameKnot) continue;
    from.push_back(knot);
    to.push_back(0.5 * (map.At(knot) + mirrored(knot) - turns));
  }
  from.push_back(from.front() + 1.0);
  to.push_back(to.front() + 1.0);
  return {std::move(from), std::move(to)};
}

}  // namespace posespace
