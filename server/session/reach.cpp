// SPDX-License-Identifier: Apache-2.0
#include "session/reach.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace posespace {
namespace {

// The poses nearest to pose i in pose space, itself left out, at most `count`.
std::vector<int> NeighboursOf(int i, const Points& placements, std::size_t count) {
  std::vector<std::pair<double, int>> others;
  for (int j = 0; j < placements.rows(); ++j) {
    if (j != i) others.emplace_back((placements.row(j) - placements.row(i)).stableNorm(), j);
  }
  std::sort(others.begin(), others.end());
  others.resize(std::min(others.size(), count));
  std::vector<int> neighbours;
  for (const auto& [distance, j] : others) neighbours.push_back(j);
  return neighbours;
}

}  // namespace

Box ReachOf(const CompatibleMesh& mesh, const RigidBlend& blend, const Points& placements,
            const Progress* progress) {
  constexpr std::size_t kNeighbours = 4;  // bounds the cost for many poses
  Box box{mesh.poses[0].row(0).transpose(), mesh.poses[0].row(0).transpose()};
  const auto include = [&box](const Points& vertices) {
    box.low = box.low.cwiseMin(vertices.colwise().minCoeff().transpose());
    box.high = box.high.cwiseMax(vertices.colwise().maxCoeff().transpose());
  };
  BlendOptions rough;
  rough.refits = 0;
  for (int i = 0; i < mesh.num_poses(); ++i) {
    include(mesh.poses[i]);
    for (const int j : NeighboursOf(i, placements, kNeighbours)) {
      if (IsCancelled(progress)) return box;
      Eigen::VectorXd halves = Eigen::VectorXd::Zero(mesh.num_poses());
      halves[i] = halves[j] = 0.5;
      include(blend.At(halves, rough));
    }
  }
  return box;
}

}  // namespace posespace
