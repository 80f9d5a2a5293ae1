// SPDX-License-Identifier: Apache-2.0
#include "mapping/chord_arrangement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

namespace posespace {
namespace {

__extension__ using Int128 = __int128;

struct Corner {
  std::int64_t x, y;
};

// Below 2^60 for corners within the radius, so that products of two fit into 127 bits.
constexpr double kRadius = 1 << 28;
std::int64_t CrossOf(const Corner& a, const Corner& b, const Corner& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Each corner lies in the first half of its own sector.
std::vector<Corner> CornersOnCircle(int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Corner> corners;
  for (int k = 0; k < n; ++k) {
    const double jitter = static_cast<double>(random() >> 11) * 0x1p-53;
    const double angle = 2.0 * std::numbers::pi * (k + 0.5 * jitter) / n;
    corners.push_back(
        {std::llround(kRadius * std::cos(angle)), std::llround(kRadius * std::sin(angle))});
  }
  return corners;
}

bool IsStrictlyConvex(std::span<const Corner> corners) {
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    if (CrossOf(corners[k], corners[(k + 1) % n], corners[(k + 2) % n]) <= 0) return false;
  }
  return true;
}

// A crossing as seen from one chord: it cuts the chord from its first end in the ratio near : far.
struct Stop {
  int vertex;
  std::int64_t near, far;
};

int CompareAlong(const Stop& p, const Stop& q) {
  const Int128 left = static_cast<Int128>(p.near) * q.far;
  const Int128 right = static_cast<Int128>(q.near) * p.far;
  return left < right ? -1 : left > right ? 1 : 0;
}

// The cyclic order of neighbours, in positive order about each vertex.
std::vector<std::vector<int>> NeighboursOf(int n, std::span<const Chord> chords,
                                           const ChordArrangement& arrangement,
                                           std::span<const std::pair<int, int>> crossings) {
  std::vector<std::vector<int>> neighbours(arrangement.num_vertices);
  // At a corner the chords turn from the next corner to the previous one, by their other end.
  std::vector<std::vector<std::pair<int, int>>> spokes(n);
  for (std::size_t c = 0; c < chords.size(); ++c) {
    const auto& [i, j] = chords[c];
    const std::vector<int>& along = arrangement.along[c];
    spokes[i].emplace_back(j - i, along[1]);
    spokes[j].emplace_back(i - j + n, along[along.size() - 2]);
  }
  for (int k = 0; k < n; ++k) {
    std::sort(spokes[k].begin(), spokes[k].end());
    neighbours[k].push_back((k + 1) % n);
    for (const auto& [turn, vertex] : spokes[k]) neighbours[k].push_back(vertex);
    neighbours[k].push_back((k + n - 1) % n);
  }
  // At a crossing of (a, b) and (c, d), a < c < b < d, the order is a, c, b, d.
  for (std::size_t x = 0; x < crossings.size(); ++x) {
    const int vertex = n + static_cast<int>(x);
    const auto around = [&](int chord) {
      const std::vector<int>& along = arrangement.along[chord];
      const auto at = std::find(along.begin(), along.end(), vertex);
      return std::pair(*(at - 1), *(at + 1));
    };
    const auto [to_a, to_b] = around(crossings[x].first);
    const auto [to_c, to_d] = around(crossings[x].second);
    neighbours[vertex] = {to_a, to_c, to_b, to_d};
  }
  return neighbours;
}

// Walks around every face but the outside, keeping it to the left.
std::vector<std::vector<int>> FacesOf(int n, const std::vector<std::vector<int>>& neighbours) {
  std::vector<std::vector<char>> walked(neighbours.size());
  for (std::size_t v = 0; v < neighbours.size(); ++v) walked[v].resize(neighbours[v].size(), 0);
  for (int k = 0; k < n; ++k) walked[k].back() = 1;  // from each corner to the previous: outside

  std::vector<std::vector<int>> faces;
  for (std::size_t start = 0; start < neighbours.size(); ++start) {
    for (std::size_t slot = 0; slot < neighbours[start].size(); ++slot) {
      if (walked[start][slot]) continue;
      std::vector<int>& face = faces.emplace_back();
      std::size_t at = start, way = slot;
      while (!walked[at][way]) {
        walked[at][way] = 1;
        face.push_back(static_cast<int>(at));
        const std::vector<int>& there = neighbours[neighbours[at][way]];
        const auto back = std::find(there.begin(), there.end(), static_cast<int>(at));
        at = neighbours[at][way];
        way = (static_cast<std::size_t>(back - there.begin()) + there.size() - 1) % there.size();
      }
    }
  }
  return faces;
}

}  // namespace

std::int64_t CountCrossings(std::span<const Chord> chords) {
  std::int64_t count = 0;
  for (std::size_t p = 0; p < chords.size(); ++p) {
    for (std::size_t q = 0; q < p; ++q) count += ChordsCross(chords[p], chords[q]) ? 1 : 0;
  }
  return count;
}

std::optional<ChordArrangement> ArrangeChords(int num_corners, std::span<const Chord> chords,
                                              std::uint64_t seed) {
  const std::vector<Corner> corners = CornersOnCircle(num_corners, seed);
  if (!IsStrictlyConvex(corners)) return std::nullopt;

  // Where each chord is crossed.
  std::vector<std::pair<int, int>> crossings;  // the chord with the smaller first end, the other
  std::vector<std::vector<Stop>> stops(chords.size());
  const auto add_stop = [&](int chord, int by, int vertex) {
    const Corner &c = corners[chords[by].first], &d = corners[chords[by].second];
    const auto distance = [&](int corner) { return std::abs(CrossOf(c, d, corners[corner])); };
    stops[chord].push_back({vertex, distance(chords[chord].first), distance(chords[chord].second)});
  };
  for (int p = 0; p < static_cast<int>(chords.size()); ++p) {
    for (int q = 0; q < static_cast<int>(chords.size()); ++q) {
      if (chords[p].first >= chords[q].first || !ChordsCross(chords[p], chords[q])) continue;
      const int vertex = num_corners + static_cast<int>(crossings.size());
      crossings.emplace_back(p, q);
      add_stop(p, q, vertex);
      add_stop(q, p, vertex);
    }
  }

  // The order along each chord.
  ChordArrangement arrangement;
  arrangement.num_vertices = num_corners + static_cast<int>(crossings.size());
  for (std::size_t c = 0; c < chords.size(); ++c) {
    std::vector<Stop>& on_chord = stops[c];
    std::sort(on_chord.begin(), on_chord.end(),
              [](const Stop& p, const Stop& q) { return CompareAlong(p, q) < 0; });
    std::vector<int>& along = arrangement.along.emplace_back();
    along.push_back(chords[c].first);
    for (std::size_t k = 0; k < on_chord.size(); ++k) {
      if (k > 0 && CompareAlong(on_chord[k - 1], on_chord[k]) == 0) return std::nullopt;
      along.push_back(on_chord[k].vertex);
    }
    along.push_back(chords[c].second);
  }
  arrangement.faces =
      FacesOf(num_corners, NeighboursOf(num_corners, chords, arrangement, crossings));
  return arrangement;
}

}  // namespace posespace
