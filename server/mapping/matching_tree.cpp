// SPDX-License-Identifier: Apache-2.0
#include "mapping/matching_tree.h"

#include <limits>

namespace posespace {

MatchingTree SpanningTree(const Eigen::MatrixXd& costs) {
  const int n = static_cast<int>(costs.rows());
  MatchingTree tree;
  costs.rowwise().sum().minCoeff(&tree.root);
  tree.parent.assign(n, -1);
  tree.order = {tree.root};

  // Prim: the cheapest drawing outside joins its cheapest neighbour inside.
  std::vector<bool> inside(n, false);
  inside[tree.root] = true;
  std::vector<int> nearest(n, tree.root);
  while (static_cast<int>(tree.order.size()) < n) {
    int next = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < n; ++i) {
      if (inside[i] || !(costs(i, nearest[i]) < least)) continue;
      least = costs(i, nearest[i]);
      next = i;
    }
    inside[next] = true;
    tree.parent[next] = nearest[next];
    tree.order.push_back(next);
    for (int i = 0; i < n; ++i) {
      if (!inside[i] && costs(i, next) < costs(i, nearest[i])) nearest[i] = next;
    }
  }
  return tree;
}

}  // namespace posespace
