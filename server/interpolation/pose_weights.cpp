// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "geometry/sparse_factor.h"
#include "interpolation/clough_tocher.h"
#include "interpolation/pose_lattice.h"
#include "interpolation/triangle_locator.h"

namespace posespace {
namespace {

// All relative to the diameter of the placements.
constexpr double kSpacing = 1.0 / 48.0;
constexpr double kMargin = 0.5;
constexpr double kEasedWidth = 0.2;  // of the band along the rim, see Eased()
constexpr double kCoincident = 1e-3;

// Outside these limits the gradient term vanishes in, or swamps, double precision.
constexpr double kLeastLevelling = 1e-2;
constexpr double kMostLevelling = 1e2;

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

// The matrix of sum over edges omega_jk |J_j - J_k|^2 + eps sum over triangles area |J|^2, with
// omega_jk = edge length / distance of the centroids and eps = 1.5 / levelling^2: mesh-size free.
// The jump of the gradient of a continuous function is normal to the edge.  Equation (1).
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
Result<Rows> LeastEnergyWeights(const SparseFactor::Matrix& energy,
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

  Rows weights(num_vertices, num_poses);
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
Rows WithGradients(const PoseLattice& lattice, const Rows& weights) {
  Rows data = Rows::Zero(3 * weights.rows(), weights.cols());
  Eigen::VectorXd area = Eigen::VectorXd::Zero(weights.rows());
  for (Eigen::Index t = 0; t < lattice.triangles.rows(); ++t) {
    const double share = AreaOf(lattice, t);
    Rows gradient = Rows::Zero(2, weights.cols());
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

// The least and the largest distance between placements.
struct Spread {
  double least = std::numeric_limits<double>::infinity();
  double diameter = 0.0;
  Eigen::Index a = 0, b = 0;  // the nearest two
};

Spread SpreadOf(const Points& placements) {
  Spread spread;
  for (Eigen::Index a = 0; a < placements.rows(); ++a) {
    for (Eigen::Index b = a + 1; b < placements.rows(); ++b) {
      const double distance = (placements.row(a) - placements.row(b)).stableNorm();
      spread.diameter = std::max(spread.diameter, distance);
      if (!(distance < spread.least)) continue;
      spread.least = distance;
      spread.a = a;
      spread.b = b;
    }
  }
  return spread;
}

Violation PlacementAt(Eigen::Index row, const std::string& description) {
  return {"placements[" + std::to_string(row) + "]", description};
}

// What is wrong with the placements, if anything.
std::optional<Error> Refusal(const Points& placements, const Spread& spread) {
  if (placements.rows() == 0) {
    return Error{ErrorCode::kNoShapes, "a pose space needs at least one placement", {}};
  }
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    if (placements.row(i).allFinite()) continue;
    return Error{ErrorCode::kPlacementNotFinite,
                 "placement " + std::to_string(i) + " is not a finite point",
                 {PlacementAt(i, "not finite")}};
  }
  if (!std::isfinite(spread.diameter)) {
    return Error{ErrorCode::kPlacementNotFinite, "the placements' distances overflow", {}};
  }
  const bool vanishes = spread.diameter < std::numeric_limits<double>::min();
  if (placements.rows() > 1 && (vanishes || spread.least < kCoincident * spread.diameter)) {
    const std::string a = std::to_string(spread.a), b = std::to_string(spread.b);
    return Error{ErrorCode::kPlacementsCoincide,
                 "placements " + a + " and " + b +
                     " are closer than 1/1000 of the distance between the farthest two",
                 {PlacementAt(spread.a, "too close to placement " + b),
                  PlacementAt(spread.b, "too close to placement " + a)}};
  }
  return std::nullopt;
}

// The placements' units and the domain [0, size], in units of their diameter.
struct Chart {
  Point low;  // of the placements' bounding box
  double diameter;

  Point ToDomain(const Point& point) const {
    return (point - low) / diameter + Point::Constant(kMargin);
  }
};

// A coordinate of the domain [0, size], brought to where the weights are read: unchanged inside,
// slowed down to a halt through a band along the rim, constant outside.  C1, so that weights are C1
// across the rim and at its corners, and their slopes fade over the band's width.
double Eased(double x, double size) {
  const auto past = [](double depth) {  // by how much to step back, `depth` into the band
    return depth * depth / (2.0 * kEasedWidth);
  };
  x = std::clamp(x, 0.0, size);
  if (x < kEasedWidth) return x + past(kEasedWidth - x);
  if (x > size - kEasedWidth) return x - past(x - (size - kEasedWidth));
  return x;
}

}  // namespace

struct PoseWeights::Field {
  struct Surface {
    Chart chart;
    PoseLattice lattice;
    TriangleLocator locator;
    Rows data;  // 3 V x N: values and gradients at the lattice's vertices
  };

  int num_poses;
  std::optional<Surface> surface;  // none for a single pose: its weight is 1 everywhere
};

Result<PoseWeights> PoseWeights::Fit(const Points& placements, const PoseWeightsOptions& options,
                                     Progress* progress) {
  const Spread spread = SpreadOf(placements);
  if (auto refusal = Refusal(placements, spread)) return *std::move(refusal);
  if (!(options.levelling >= kLeastLevelling && options.levelling <= kMostLevelling)) {
    return Error{ErrorCode::kInvalidOption,
                 "levelling must lie between 0.01 and 100",
                 {{"levelling", "out of range"}}};
  }
  if (placements.rows() == 1) {
    return PoseWeights(std::make_shared<const Field>(Field{1, std::nullopt}));
  }

  const Chart chart{placements.colwise().minCoeff().transpose(), spread.diameter};
  Points in_domain(placements.rows(), 2);
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    in_domain.row(i) = chart.ToDomain(placements.row(i).transpose());
  }
  const Point size = in_domain.colwise().maxCoeff().transpose() + Point::Constant(kMargin);

  const Error cancelled{ErrorCode::kCancelled, "the fit of the weights was cancelled", {}};
  PoseLattice lattice = TessellateAround(in_domain, size, kSpacing);
  if (IsCancelled(progress)) return cancelled;
  Report(progress, 0.2);
  const SparseFactor::Matrix energy = EnergyOf(lattice, options.levelling);
  if (IsCancelled(progress)) return cancelled;
  Report(progress, 0.3);
  const Rows weights = TRY(LeastEnergyWeights(energy, lattice.pose_vertices));
  if (IsCancelled(progress)) return cancelled;
  Report(progress, 0.9);

  Rows data = WithGradients(lattice, weights);
  TriangleLocator locator(lattice.vertices, lattice.triangles, size, lattice.spacing);
  Report(progress, 1.0);
  return PoseWeights(std::make_shared<const Field>(
      Field{static_cast<int>(placements.rows()),
            Field::Surface{chart, std::move(lattice), std::move(locator), std::move(data)}}));
}

Eigen::VectorXd PoseWeights::At(const Point& point) const {
  if (!field_->surface) return Eigen::VectorXd::Ones(1);
  const auto& [chart, lattice, locator, data] = *field_->surface;
  const Point place = chart.ToDomain(point);
  const auto [t, barycentric] =
      locator.Find(Point(Eased(place.x(), lattice.size.x()), Eased(place.y(), lattice.size.y())));

  std::array<Point, 3> corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = lattice.vertices.row(lattice.triangles(t, k)).transpose();
  const CornerShares shares = CloughTocher(corners, barycentric);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(field_->num_poses);
  for (int k = 0; k < 3; ++k) {
    for (int d = 0; d < 3; ++d) {
      weights += shares[k][d] * data.row(3 * lattice.triangles(t, k) + d).transpose();
    }
  }
  return weights;
}

int PoseWeights::num_poses() const { return field_->num_poses; }

}  // namespace posespace
