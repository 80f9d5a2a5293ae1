// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MATCHING_TREE_H_
#define POSESPACE_MAPPING_MATCHING_TREE_H_

#include <Eigen/Core>
#include <vector>

namespace posespace {

// A tree over N drawings along which matches are composed.
struct MatchingTree {
  int root;                 // the drawing that is least unlike all others
  std::vector<int> parent;  // -1 at the root
  std::vector<int> order;   // parents before children, the root first
};

// The minimum spanning tree of a symmetric matrix of costs.  Equal costs go by the drawings'
// numbers.
MatchingTree SpanningTree(const Eigen::MatrixXd& costs);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MATCHING_TREE_H_
