// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_OUTLINE_CHORDS_H_
#define POSESPACE_MAPPING_OUTLINE_CHORDS_H_

#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"

namespace posespace {

using Chord = std::pair<int, int>;  // (i, j), i < j, of a K-gon

inline bool ChordsCross(const Chord& p, const Chord& q) {
  return (p.first < q.first && q.first < p.second && p.second < q.second) ||
         (q.first < p.first && p.first < q.second && q.second < p.second);
}

// For each outline the K - 3 chords, sorted, of one of its own triangulations, chosen so that few
// chords of different outlines cross when all are drawn in one convex K-gon.  Each outline in turn
// takes the triangulation that adds fewest crossings to the others', until that stops helping.
// Empty when cancelled.
//
// Requires  simple, positively oriented outlines of equal size.
// Cost      O(N K^3) a round, a few rounds.
std::vector<std::vector<Chord>> ChooseChords(std::span<const Points> outlines, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_OUTLINE_CHORDS_H_
