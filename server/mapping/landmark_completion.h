// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_LANDMARK_COMPLETION_H_
#define POSESPACE_MAPPING_LANDMARK_COMPLETION_H_

#include <functional>
#include <vector>

#include "mapping/landmark_marks.h"
#include "mapping/matching_tree.h"
#include "mapping/outline_map.h"
#include "mapping/pair_matching.h"

namespace posespace {

// positions[landmark][drawing]: where each landmark lies on every outline.
using LandmarkPositions = std::vector<std::vector<double>>;

// A match from the outline of drawing `a` to that of drawing `b` through the anchors.
using AnchoredMatch = std::function<OutlineMap(int a, int b, const std::vector<Anchor>& anchors)>;

// The landmarks in `order` that both drawings have, as anchors of a match from a to b.
std::vector<Anchor> CommonAnchors(const std::vector<int>& order, const LandmarkPositions& positions,
                                  int a, int b);

// Finds each landmark's place on the drawings that do not mark it, from the matches along the tree:
// first from the leaves up, so that the root has every landmark, then down.  Marks stay where they
// are, and every drawing ends with all landmarks in one cyclic order, `order`.
//
// Requires  an order of all landmarks that agrees with each drawing's marks, every landmark marked
// in
//           some drawing.
LandmarkPositions CompleteLandmarks(const Marks& marks, const std::vector<int>& order,
                                    const MatchingTree& tree, const AnchoredMatch& match);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_LANDMARK_COMPLETION_H_
