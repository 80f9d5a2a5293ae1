// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_CHORD_ARRANGEMENT_H_
#define POSESPACE_MAPPING_CHORD_ARRANGEMENT_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mapping/outline_chords.h"

namespace posespace {

// Chords of a convex K-gon and the faces into which they cut it.  Vertices are the corners [0, K)
// and then one for each crossing of two chords.
struct ChordArrangement {
  int num_vertices = 0;
  std::vector<std::vector<int>>
      along;  // per chord: its vertices from first end to second, with them
  std::vector<std::vector<int>> faces;  // vertices in positive order, each face strictly convex
};

// How many pairs of the chords cross.  Requires distinct chords.
std::int64_t CountCrossings(std::span<const Chord> chords);

// Draws the chords in a K-gon with corners at random angles on a circle, in integer coordinates,
// and decides the order of crossings in exact integers.  Nothing when three chords meet in one
// point or the K-gon is not strictly convex: draw again with another seed.
//
// Requires  distinct chords, none a side.
// Cost      O(C^2 + X log X) for C chords and X crossings.
std::optional<ChordArrangement> ArrangeChords(int num_corners, std::span<const Chord> chords,
                                              std::uint64_t seed);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_CHORD_ARRANGEMENT_H_
