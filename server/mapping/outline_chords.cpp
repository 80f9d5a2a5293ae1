// SPDX-License-Identifier: Apache-2.0
#include "mapping/outline_chords.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "geometry/polygon.h"
#include "mapping/ring_programme.h"
#include "mapping/triangle_quality.h"

namespace posespace {
namespace {

constexpr int kMaxRounds = 8;
// Against one crossing: a chord as long as the drawing, a triangle of sharpness 1, and a first
// choice of a chord that cannot be a diagonal of some other outline.
constexpr double kLengthCost = 1e-3;
constexpr double kSharpnessCost = 1e-3;
constexpr double kMaxSharpness = 1e12;
constexpr double kStrangerCost = 0.5;

// How many of a set of chords cross a given one, in constant time each.
class CrossingCounter {
 public:
  CrossingCounter(int n, std::span<const Chord> chords)
      : n_(n), sums_(static_cast<std::size_t>(n + 1) * (n + 1), 0) {
    for (const auto& [i, j] : chords) At(i + 1, j + 1) = 1;
    for (int i = 1; i <= n; ++i) {
      for (int j = 1; j <= n; ++j) At(i, j) += At(i - 1, j) + At(i, j - 1) - At(i - 1, j - 1);
    }
  }

  int Count(int i, int j) const { return Within(i + 1, j, j + 1, n_) + Within(0, i, i + 1, j); }
  bool Contains(int i, int j) const { return Within(i, i + 1, j, j + 1) != 0; }

 private:
  int& At(int i, int j) { return sums_[static_cast<std::size_t>(i) * (n_ + 1) + j]; }
  int At(int i, int j) const { return sums_[static_cast<std::size_t>(i) * (n_ + 1) + j]; }
  // Chords whose first end is in [i0, i1) and whose second end is in [j0, j1).
  int Within(int i0, int i1, int j0, int j1) const {
    return At(i1, j1) - At(i0, j1) - At(i1, j0) + At(i0, j0);
  }

  int n_;
  std::vector<int> sums_;
};

std::vector<Chord> UnionOf(std::span<const std::vector<Chord>> sets, std::size_t left_out) {
  std::vector<Chord> chords;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (s != left_out) chords.insert(chords.end(), sets[s].begin(), sets[s].end());
  }
  std::sort(chords.begin(), chords.end());
  chords.erase(std::unique(chords.begin(), chords.end()), chords.end());
  return chords;
}

long long CountCrossings(int n, std::span<const std::vector<Chord>> sets) {
  const std::vector<Chord> chords = UnionOf(sets, sets.size());
  const CrossingCounter counter(n, chords);
  long long twice = 0;
  for (const auto& [i, j] : chords) twice += counter.Count(i, j);
  return twice / 2;
}

// The triangulation of `outline` with the least sum of chord costs and a little of its own looks.
template <typename ChordCost>
std::vector<Chord> CheapestChords(const Points& outline, const ChordTable& inside,
                                  ChordCost chord_cost, Progress* progress) {
  const int n = static_cast<int>(outline.rows());
  const double size = std::sqrt(SignedArea(outline));
  const auto triangle_cost = [&](int i, int k, int j) {
    const Point a = outline.row(i), b = outline.row(k), c = outline.row(j);
    if (Orientation(a, b, c) <= 0) return std::numeric_limits<double>::infinity();
    const double shape = kSharpnessCost * std::min(Sharpness(a, b, c), kMaxSharpness);
    if (j - i == n - 1) return shape;
    return shape + kLengthCost * (c - a).norm() / size + chord_cost(i, j);
  };
  const auto sum = [](float left, float right, float triangle) { return left + right + triangle; };
  const auto triangles = CheapestRingTriangulation(inside, triangle_cost, sum, progress);
  std::vector<Chord> chords;
  if (!triangles) return chords;
  for (const auto& [i, k, j] : *triangles) {
    if (j - i < n - 1) chords.emplace_back(i, j);
  }
  std::sort(chords.begin(), chords.end());
  return chords;
}

}  // namespace

std::vector<std::vector<Chord>> ChooseChords(std::span<const Points> outlines, Progress* progress) {
  const int n = static_cast<int>(outlines[0].rows());
  std::vector<ChordTable> inside;
  for (const Points& outline : outlines) inside.emplace_back(n).KeepChordsInside(outline);
  const auto strangers = [&](int i, int j) {
    return std::count_if(inside.begin(), inside.end(),
                         [&](const ChordTable& table) { return !table.Allows(i, j); });
  };

  std::vector<std::vector<Chord>> chosen(outlines.size()), best;
  long long fewest = std::numeric_limits<long long>::max();
  for (int round = 0; round < kMaxRounds; ++round) {
    for (std::size_t s = 0; s < outlines.size(); ++s) {
      const CrossingCounter others(n, UnionOf(chosen, s));
      const auto chord_cost = [&](int i, int j) {
        if (others.Contains(i, j)) return 0.0;
        const double prior =
            round == 0 ? kStrangerCost * static_cast<double>(strangers(i, j)) : 0.0;
        return others.Count(i, j) + prior;
      };
      chosen[s] = CheapestChords(outlines[s], inside[s], chord_cost, progress);
      if (IsCancelled(progress)) return {};
    }
    const long long crossings = CountCrossings(n, chosen);
    if (crossings >= fewest) break;
    fewest = crossings;
    best = chosen;
  }
  return best;
}

}  // namespace posespace
