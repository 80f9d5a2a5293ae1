// SPDX-License-Identifier: Apache-2.0
#include "mapping/outline_mismatch.h"

#include <algorithm>
#include <cmath>

namespace posespace {
namespace {

constexpr double kMismatchSlope = 4.5;
constexpr double kLeastMismatch = 0.15;  // well matched drawings reach 0.14
constexpr double kLeastMarkedMismatch = 0.12;
constexpr int kMismatchSteps = 256;

// The share of two outlines, with maps from a common parameter and from `from` for `length` turns
// of it, that is longer in one than in the other by more than kMismatchSlope.
double MismatchShare(const OutlineMap& a, const OutlineMap& b, double from, double length) {
  double share = 0.0;
  for (int k = 0; k < kMismatchSteps; ++k) {
    const double begin = from + length * k / kMismatchSteps;
    const double end = from + length * (k + 1) / kMismatchSteps;
    const double on_a = a.At(end) - a.At(begin), on_b = b.At(end) - b.At(begin);
    if (std::max(on_a, on_b) > kMismatchSlope * std::min(on_a, on_b)) share += 0.5 * (on_a + on_b);
  }
  return share;
}

// The landmarks at the ends of the arc where most of the mismatch of two maps lies.
std::vector<int> LandmarksAround(const OutlineMap& a, const OutlineMap& b,
                                 const std::vector<double>& landmarks,
                                 const std::vector<int>& order) {
  std::vector<int> around;
  double most = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int begin = order[k], end = order[(k + 1) % order.size()];
    const double from = landmarks[begin];
    double length = landmarks[end] - from;
    length -= std::floor(length);
    if (begin == end) length = 1.0;
    const double share = MismatchShare(a, b, from, length);
    if (share <= most) continue;
    most = share;
    around = begin == end ? std::vector<int>{begin} : std::vector<int>{begin, end};
  }
  return around;
}

}  // namespace

std::optional<Mismatch> FindMismatch(const std::vector<OutlineMap>& maps,
                                     const std::vector<double>& landmarks,
                                     const std::vector<int>& order) {
  const double least = landmarks.empty() ? kLeastMismatch : kLeastMarkedMismatch;
  const int n = static_cast<int>(maps.size());
  std::optional<Mismatch> worst;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      const double share = MismatchShare(maps[i], maps[j], 0.0, 1.0);
      if (share > (worst ? worst->share : least)) worst = Mismatch{i, j, share, {}};
    }
  }
  if (worst) {
    worst->landmarks = LandmarksAround(maps[worst->first], maps[worst->second], landmarks, order);
  }
  return worst;
}

}  // namespace posespace
