// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_TRIANGULATION_LEVELS_H_
#define POSESPACE_MAPPING_TRIANGULATION_LEVELS_H_

#include <array>
#include <cstddef>

namespace posespace {

// What a compatible triangulation does with a part of the outlines, simplest first.
enum class Level {
  kZeroSteiner,  // triangulates it without a Steiner vertex (zero_steiner.h)
  kStraightCut,  // stage I: cuts it in two by a chord
  kOnePointCut,  // stage II: cuts it in two over one Steiner vertex
  kLinkPathCut,  // stage III: cuts it in two along a path of several Steiner vertices
  kOverlay,      // lays the outlines' own triangulations over each other; never fails
};
inline constexpr std::size_t kNumLevels = 5;

struct LevelCount {
  int parts = 0;             // triangulated or cut by this level
  int steiner_vertices = 0;  // of it in the mesh
  bool operator==(const LevelCount&) const = default;
};

// One for each Level, in order.
using LevelCounts = std::array<LevelCount, kNumLevels>;

// The name of a level in reports.
inline constexpr std::array<const char*, kNumLevels> kLevelNames = {
    "zero_steiner", "straight_cut", "one_point_cut", "link_path_cut", "overlay"};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_TRIANGULATION_LEVELS_H_
