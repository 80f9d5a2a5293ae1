// SPDX-License-Identifier: Apache-2.0
#include "mapping/chord_arrangement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace posespace {
namespace {

TEST(ArrangeChords, CutsAHexagonByItsThreeLongDiagonalsIntoSevenFaces) {
  const std::vector<Chord> chords = {{0, 3}, {1, 4}, {2, 5}};
  const auto arrangement = ArrangeChords(6, chords, 1);
  ASSERT_TRUE(arrangement.has_value());
  EXPECT_EQ(arrangement->num_vertices, 9);
  EXPECT_EQ(arrangement->faces.size(), 7U);
  for (const std::vector<int>& along : arrangement->along) EXPECT_EQ(along.size(), 4U);
}

TEST(ArrangeChords, HasOneFaceWithoutChords) {
  const auto arrangement = ArrangeChords(5, {}, 1);
  ASSERT_TRUE(arrangement.has_value());
  ASSERT_EQ(arrangement->faces.size(), 1U);
  EXPECT_EQ(arrangement->faces[0].size(), 5U);
}

// Euler: each chord and each crossing adds a face.  Each edge has a face on either side but for the
// rim, whose sides occur once, forwards.
TEST(ArrangeChords, FacesFitTogetherForRandomChords) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 5 + static_cast<int>(random() % 40);
    std::set<Chord> drawn;
    for (int c = 0; c < 60; ++c) {
      const int i = static_cast<int>(random() % n), j = static_cast<int>(random() % n);
      const auto [low, high] = std::minmax(i, j);
      if (high - low > 1 && high - low < n - 1) drawn.emplace(low, high);
    }
    const std::vector<Chord> chords(drawn.begin(), drawn.end());
    const auto arrangement = ArrangeChords(n, chords, random());
    ASSERT_TRUE(arrangement.has_value());
    const auto crossings = static_cast<std::size_t>(CountCrossings(chords));
    EXPECT_EQ(arrangement->num_vertices, n + static_cast<int>(crossings));
    EXPECT_EQ(arrangement->faces.size(), 1 + chords.size() + crossings);
    std::set<std::pair<int, int>> sides;
    for (const std::vector<int>& face : arrangement->faces) {
      EXPECT_GE(face.size(), 3U);
      for (std::size_t k = 0; k < face.size(); ++k) {
        EXPECT_TRUE(sides.emplace(face[k], face[(k + 1) % face.size()]).second);
      }
    }
    for (const auto& [from, to] : sides) {
      const bool rim = from < n && to == (from + 1) % n;
      EXPECT_EQ(sides.contains({to, from}), !rim) << from << " -> " << to;
    }
  }
}

}  // namespace
}  // namespace posespace
