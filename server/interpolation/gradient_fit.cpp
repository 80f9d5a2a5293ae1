// SPDX-License-Identifier: Apache-2.0
#include "interpolation/gradient_fit.h"

#include <algorithm>
#include <numeric>

namespace posespace {

VertexParts PartsOf(const Triangles& triangles, int num_vertices) {
  std::vector<int> parent(static_cast<std::size_t>(num_vertices));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& triangle : triangles.rowwise()) {
    for (int k = 1; k < 3; ++k) {
      const int a = root(triangle[0]), b = root(triangle[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  VertexParts parts{std::vector<int>(parent.size()), 0};
  for (int v = 0; v < num_vertices; ++v) {
    parts.part_of[v] = root(v) == v ? parts.count++ : parts.part_of[root(v)];
  }
  return parts;
}

SparseFactor::Matrix NormalMatrix(const Triangles& triangles, const VertexParts& parts,
                                  const Eigen::MatrixXd& gradients, const Eigen::VectorXd& masses) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(triangles.rows()) * 9 + parts.count);
  std::vector<double> stiffest(static_cast<std::size_t>(parts.count), 0.0);
  for (int t = 0; t < triangles.rows(); ++t) {
    double& part_stiffest = stiffest[parts.part_of[triangles(t, 0)]];
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        const double dot = gradients(t, 2 * j) * gradients(t, 2 * k) +
                           gradients(t, 2 * j + 1) * gradients(t, 2 * k + 1);
        entries.emplace_back(triangles(t, j), triangles(t, k), masses[t] * dot);
        part_stiffest = std::max(part_stiffest, masses[t] * dot);
      }
    }
  }

  // Translations of a part cost nothing.  A spring to 0 at its first vertex fixes them and strains
  // nothing: the right-hand side sums to zero over the part, so that vertex lies at 0.
  int next_part = 0;
  for (int v = 0; v < static_cast<int>(parts.part_of.size()); ++v) {
    if (parts.part_of[v] != next_part) continue;
    entries.emplace_back(v, v, stiffest[next_part++]);
  }

  const auto num_vertices = static_cast<Eigen::Index>(parts.part_of.size());
  SparseFactor::Matrix normal(num_vertices, num_vertices);
  normal.setFromTriplets(entries.begin(), entries.end());
  return normal;
}

Result<GradientFit> GradientFit::Prepare(const Triangles& triangles, const VertexParts& parts,
                                         const Eigen::MatrixXd& gradients,
                                         const Eigen::VectorXd& masses) {
  auto factor = TRY(SparseFactor::Factor(NormalMatrix(triangles, parts, gradients, masses)));
  return GradientFit(triangles, static_cast<Eigen::Index>(parts.part_of.size()),
                     masses.asDiagonal() * gradients, std::move(factor));
}

Eigen::MatrixXd GradientFit::Solve(const Eigen::MatrixXd& targets) const {
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(num_vertices_, 2);
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const double xx = targets(t, 0), xy = targets(t, 1), yx = targets(t, 2), yy = targets(t, 3);
    for (int k = 0; k < 3; ++k) {
      const double gx = weighted_gradients_(t, 2 * k), gy = weighted_gradients_(t, 2 * k + 1);
      right(triangles_(t, k), 0) += xx * gx + xy * gy;
      right(triangles_(t, k), 1) += yx * gx + yy * gy;
    }
  }
  return factor_.Solve(right);
}

void GradientFit::WeightedMaps(const Points& vertices, Eigen::MatrixXd* maps) const {
  maps->resize(triangles_.rows(), 4);
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    double xx = 0.0, xy = 0.0, yx = 0.0, yy = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double gx = weighted_gradients_(t, 2 * k), gy = weighted_gradients_(t, 2 * k + 1);
      const double x = vertices(triangles_(t, k), 0), y = vertices(triangles_(t, k), 1);
      xx += x * gx;
      xy += x * gy;
      yx += y * gx;
      yy += y * gy;
    }
    (*maps)(t, 0) = xx;
    (*maps)(t, 1) = xy;
    (*maps)(t, 2) = yx;
    (*maps)(t, 3) = yy;
  }
}

}  // namespace posespace
