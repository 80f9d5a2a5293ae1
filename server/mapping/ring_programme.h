// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_RING_PROGRAMME_H_
#define POSESPACE_MAPPING_RING_PROGRAMME_H_

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"

namespace posespace {

using Triangle = std::array<int, 3>;

// Which chords (i, j) of an n-gon a triangulation may use.  Sides are always allowed.
class ChordTable {
 public:
  explicit ChordTable(int n) : n_(n), allowed_(static_cast<std::size_t>(n) * n, 1) {}

  int size() const { return n_; }
  bool Allows(int i, int j) const { return allowed_[Index(i, j)] != 0; }
  void Forbid(int i, int j) { allowed_[Index(i, j)] = allowed_[Index(j, i)] = 0; }

  // Forbids every chord that does not leave both of its ends into the ring's inside.  Necessary for
  // a chord to be a diagonal, not sufficient; exact.
  void KeepChordsInside(const Points& ring);

 private:
  std::size_t Index(int i, int j) const { return static_cast<std::size_t>(i) * n_ + j; }

  int n_;
  std::vector<std::uint8_t> allowed_;
};

// The cheapest triangulation of an n-gon without Steiner vertices (Klincsek 1980), or nothing when
// every one costs infinity or when cancelled.  Triangles are (i, k, j) with i < k < j.
//
// `triangle_cost(i, k, j)` >= 0 may charge for the chord (i, j) too: each chord is the longest side
// (i, j) of exactly one triangle.  `join(left, right, triangle)` adds costs up, as a sum or a
// maximum, and never falls when an argument rises.
//
// That a set of positive triangles is valid needs no test of visibility: it covers each point as
// often as the ring winds about it, which is once inside a simple, positively oriented ring.
//
// Cost      O(n^3) time, O(n^2) memory.
template <typename TriangleCost, typename Join>
std::optional<std::vector<Triangle>> CheapestRingTriangulation(const ChordTable& chords,
                                                               TriangleCost triangle_cost,
                                                               Join join, Progress* progress) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  const int n = chords.size();
  const auto index = [n](int i, int j) { return static_cast<std::size_t>(i) * n + j; };
  // Symmetric, so that both factors of a split are read along a row.
  std::vector<float> cost(static_cast<std::size_t>(n) * n, kInfinite);
  std::vector<std::int32_t> split(cost.size(), -1);
  for (int i = 0; i + 1 < n; ++i) cost[index(i, i + 1)] = cost[index(i + 1, i)] = 0.0F;

  for (int length = 2; length < n; ++length) {
    for (int i = 0; i + length < n; ++i) {
      if (IsCancelled(progress)) return std::nullopt;
      const int j = i + length;
      if (length < n - 1 && !chords.Allows(i, j)) continue;
      const float* const left = &cost[index(i, 0)];
      const float* const right = &cost[index(j, 0)];
      float best = kInfinite;
      for (int k = i + 1; k < j; ++k) {
        if (!(join(left[k], right[k], 0.0F) < best)) continue;
        const float total = join(left[k], right[k], static_cast<float>(triangle_cost(i, k, j)));
        if (total < best) {
          best = total;
          split[index(i, j)] = k;
        }
      }
      cost[index(i, j)] = cost[index(j, i)] = best;
    }
  }
  if (!(cost[index(0, n - 1)] < kInfinite)) return std::nullopt;

  std::vector<Triangle> triangles;
  triangles.reserve(n - 2);
  std::vector<std::pair<int, int>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = split[index(i, j)];
    triangles.push_back({i, k, j});
    open.emplace_back(k, j);
    open.emplace_back(i, k);
  }
  return triangles;
}

}  // namespace posespace

#endif  // POSESPACE_MAPPING_RING_PROGRAMME_H_
