// SPDX-License-Identifier: Apache-2.0
#include "interpolation/biharmonic_fit.h"

#include <array>

#include "geometry/sparse_factor.h"

namespace posespace {
namespace {

// The gradients (columns) of a triangle's three hat functions.
Eigen::Matrix<double, 2, 3> HatGradients(const PoseLattice& lattice, Eigen::Index t) {
  Eigen::Matrix<double, 2, 3> gradients;
  for (int k = 0; k < 3; ++k) {
    const Point opposite = lattice.vertices.row(lattice.triangles(t, (k + 2) % 3)) -
                           lattice.vertices.row(lattice.triangles(t, (k + 1) % 3));
    gradients.col(k) << -opposite.y(), opposite.x();
  }
  const double twice_area = gradients(0, 1) * gradients(1, 2) - gradients(1, 1) * gradients(0, 2);
  return gradients / twice_area;
}

double AreaOf(const PoseLattice& lattice, Eigen::Index t) {
  const auto corner = [&](int k) -> Point {
    return lattice.vertices.row(lattice.triangles(t, k)).transpose();
  };
  return 0.5 * Cross(corner(0), corner(1), corner(2));
}

Point CentroidOf(const PoseLattice& lattice, Eigen::Index t) {
  Point sum = Point::Zero();
  for (int k = 0; k < 3; ++k) sum += lattice.vertices.row(lattice.triangles(t, k)).transpose();
  return sum / 3.0;
}

// The energy's matrix.  The jump of a continuous function's gradient is normal to the edge, so each
// edge adds a single square.  Equation (1).
SparseFactor::Matrix EnergyOf(const PoseLattice& lattice, double levelling) {
  const Edges edges = EdgesOf(lattice.triangles);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(16 * edges.rows() + 9 * lattice.triangles.rows()));

  for (const auto& edge : edges.rowwise()) {
    if (edge[3] < 0) continue;
    const Point along = lattice.vertices.row(edge[1]) - lattice.vertices.row(edge[0]);
    const Eigen::RowVector2d normal = Eigen::RowVector2d(-along.y(), along.x()) / along.norm();
    std::array<int, 4> vertex{edge[0], edge[1], -1, -1};
    std::array<double, 4> jump{};
    for (int side = 0; side < 2; ++side) {
      const int t = edge[2 + side];
      const Eigen::RowVector3d slopes =
          (side == 0 ? 1.0 : -1.0) * normal * HatGradients(lattice, t);
      for (int k = 0; k < 3; ++k) {
        const int v = lattice.triangles(t, k);
        const int slot = v == vertex[0] ? 0 : v == vertex[1] ? 1 : 2 + side;
        vertex[slot] = v;
        jump[slot] += slopes[k];
      }
    }
    const double omega =
        along.norm() / (CentroidOf(lattice, edge[2]) - CentroidOf(lattice, edge[3])).norm();
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        entries.emplace_back(vertex[j], vertex[k], omega * jump[j] * jump[k]);
      }
    }
  }

  const double eps = 1.5 / (levelling * levelling);
  for (Eigen::Index t = 0; t < lattice.triangles.rows(); ++t) {
    const auto gradients = HatGradients(lattice, t);
    const Eigen::Matrix3d stiffness = eps * AreaOf(lattice, t) * gradients.transpose() * gradients;
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        entries.emplace_back(lattice.triangles(t, j), lattice.triangles(t, k), stiffness(j, k));
      }
    }
  }

  SparseFactor::Matrix energy(lattice.vertices.rows(), lattice.vertices.rows());
  energy.setFromTriplets(entries.begin(), entries.end());
  return energy;
}

// The V x N values of least energy that are the unit vectors at the poses' vertices.
Result<LatticeData> LeastEnergyWeights(const SparseFactor::Matrix& energy,
                                       const std::vector<int>& pose_vertices) {
  const Eigen::Index num_vertices = energy.rows();
  const auto num_poses = static_cast<Eigen::Index>(pose_vertices.size());

  // Eliminate the poses' vertices: A_ff W_f = -A_fp.
  std::vector<int> pose_of(static_cast<std::size_t>(num_vertices), -1);
  for (Eigen::Index i = 0; i < num_poses; ++i) pose_of[pose_vertices[i]] = static_cast<int>(i);
  std::vector<int> unknown_of(pose_of.size(), -1);
  int num_unknowns = 0;
  for (std::size_t v = 0; v < pose_of.size(); ++v) {
    if (pose_of[v] < 0) unknown_of[v] = num_unknowns++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(energy.nonZeros()));
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(num_unknowns, num_poses);
  for (Eigen::Index column = 0; column < num_vertices; ++column) {
    for (SparseFactor::Matrix::InnerIterator entry(energy, column); entry; ++entry) {
      const int row = unknown_of[entry.row()];
      if (row < 0) continue;
      if (pose_of[column] >= 0) {
        right(row, pose_of[column]) -= entry.value();
      } else {
        entries.emplace_back(row, unknown_of[column], entry.value());
      }
    }
  }
  SparseFactor::Matrix matrix(num_unknowns, num_unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto factor = TRY(SparseFactor::Factor(matrix));
  Eigen::MatrixXd free_weights = factor.Solve(right);

  // Constants cost nothing, so each row sums to one but for rounding, which is spread evenly.
  const Eigen::VectorXd excess =
      (free_weights.rowwise().sum().array() - 1.0) / static_cast<double>(num_poses);
  free_weights.colwise() -= excess;

  LatticeData weights(num_vertices, num_poses);
  for (Eigen::Index v = 0; v < num_vertices; ++v) {
    if (pose_of[v] >= 0) {
      weights.row(v) = Eigen::RowVectorXd::Unit(num_poses, pose_of[v]);
    } else {
      weights.row(v) = free_weights.row(unknown_of[v]);
    }
  }
  return weights;
}

// Values and gradients, 3 V x N: row 3 v + k is the value, x and y slope at vertex v.  A vertex's
// gradient is the area-weighted mean of its triangles'.
LatticeData WithGradients(const PoseLattice& lattice, const LatticeData& weights) {
  LatticeData data = LatticeData::Zero(3 * weights.rows(), weights.cols());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(weights.rows());
  for (Eigen::Index t = 0; t < lattice.triangles.rows(); ++t) {
    const double share = AreaOf(lattice, t);
    LatticeData gradient = LatticeData::Zero(2, weights.cols());
    const auto hats = HatGradients(lattice, t);
    for (int k = 0; k < 3; ++k) gradient += hats.col(k) * weights.row(lattice.triangles(t, k));
    for (int k = 0; k < 3; ++k) {
      data.middleRows(3 * lattice.triangles(t, k) + 1, 2) += share * gradient;
      area[lattice.triangles(t, k)] += share;
    }
  }
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    data.row(3 * v) = weights.row(v);
    data.middleRows(3 * v + 1, 2) /= area[v];
  }
  return data;
}

}  // namespace

Result<LatticeData> FitBiharmonic(const PoseLattice& lattice, double levelling,
                                  Progress* progress) {
  const Error cancelled{ErrorCode::kCancelled, "the fit of the weights was cancelled", {}};
  if (IsCancelled(progress)) return cancelled;
  const SparseFactor::Matrix energy = EnergyOf(lattice, levelling);
  Report(progress, 0.3);
  if (IsCancelled(progress)) return cancelled;
  const LatticeData weights = TRY(LeastEnergyWeights(energy, lattice.pose_vertices));
  Report(progress, 0.9);
  if (IsCancelled(progress)) return cancelled;
  return WithGradients(lattice, weights);
}

}  // namespace posespace
