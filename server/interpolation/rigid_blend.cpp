// SPDX-License-Identifier: Apache-2.0
#include "interpolation/rigid_blend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "geometry/polygon.h"
#include "interpolation/gradient_fit.h"
#include "interpolation/triangle_maps.h"

namespace posespace {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// A solution that folds so much that less than this share of its triangles' areas is left has no
// useful centroid; its triangles then count with their absolute areas.
constexpr double kLeastArea = 1e-3;

// A row per part: the centroid of its area, sum of signed triangle areas times triangle centroids
// over the sum of signed areas.
template <typename Vertices>
Points PartCentroids(const Triangles& triangles, const Vertices& vertices,
                     const VertexParts& parts) {
  struct Moment {
    Point origin = Point::Zero(), signed_sum = Point::Zero(), absolute_sum = Point::Zero();
    double signed_area = 0.0, absolute_area = 0.0;
  };
  std::vector<Moment> moments(static_cast<std::size_t>(parts.count));
  for (const auto& triangle : triangles.rowwise()) {
    const Point a = vertices.row(triangle[0]).transpose();
    const Point b = vertices.row(triangle[1]).transpose();
    const Point c = vertices.row(triangle[2]).transpose();
    const double area = Cross(a, b, c);
    Moment& moment = moments[parts.part_of[triangle[0]]];
    if (moment.absolute_area == 0.0) moment.origin = a;  // keeps digits far from (0, 0)
    const Point arm = ((a - moment.origin) + (b - moment.origin) + (c - moment.origin)) / 3.0;
    moment.signed_sum += area * arm;
    moment.signed_area += area;
    moment.absolute_sum += std::abs(area) * arm;
    moment.absolute_area += std::abs(area);
  }
  Points centroids(parts.count, 2);
  for (int part = 0; part < parts.count; ++part) {
    const Moment& moment = moments[part];
    Point centroid = moment.origin;
    if (moment.signed_area > kLeastArea * moment.absolute_area) {
      centroid += moment.signed_sum / moment.signed_area;
    } else if (moment.absolute_area > 0.0) {
      centroid += moment.absolute_sum / moment.absolute_area;
    }
    centroids.row(part) = centroid;
  }
  return centroids;
}

// Adds whole turns to the rotations of `pose` so that each edge-connected part's area-weighted mean
// lies in (-pi, pi] plus `turns`, and returns the whole mesh's mean before `turns`.  Half a turn
// stays +pi whatever the rounding.
double WrapRotations(const std::vector<int>& part_of, int pose, int turns, TriangleMaps* rigid,
                     TriangleMaps* paper) {
  const int num_parts = 1 + *std::max_element(part_of.begin(), part_of.end());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(num_parts), area = Eigen::VectorXd::Zero(num_parts);
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    sum[part_of[t]] += rigid->areas[t] * rigid->rotations(t, pose);
    area[part_of[t]] += rigid->areas[t];
  }
  constexpr double kRounding = 1e-9;
  const Eigen::VectorXd excess = (sum.cwiseQuotient(area) / kTurn).unaryExpr([](double mean_turns) {
    return std::ceil(mean_turns - 0.5 - kRounding);
  });
  for (std::size_t t = 0; t < part_of.size(); ++t) {
    const double shift = kTurn * (turns - excess[part_of[t]]);
    rigid->rotations(t, pose) += shift;
    paper->rotations(t, pose) += shift;
  }
  return (sum - kTurn * area.cwiseProduct(excess)).sum() / area.sum();
}

// R(angle) S of every triangle, with the rotations as cosines and sines.
void AssembleTargets(const Eigen::ArrayXd& cosines, const Eigen::ArrayXd& sines,
                     const Eigen::ArrayXd& stretch, Eigen::MatrixXd* targets) {
  const Eigen::Index count = cosines.size();
  const auto xx = stretch.head(count), xy = stretch.segment(count, count), yy = stretch.tail(count);
  targets->resize(count, 4);
  targets->col(0).array() = cosines * xx - sines * xy;
  targets->col(1).array() = cosines * xy - sines * yy;
  targets->col(2).array() = sines * xx + cosines * xy;
  targets->col(3).array() = sines * xy + cosines * yy;
}

// The rotations nearest to J S, whatever the positive factor of each J; a triangle that has none
// keeps its old one.
void RefitRotations(const Eigen::MatrixXd& maps, const Eigen::ArrayXd& stretch,
                    Eigen::ArrayXd* cosines, Eigen::ArrayXd* sines) {
  const Eigen::Index count = cosines->size();
  for (Eigen::Index t = 0; t < count; ++t) {
    const double xx = stretch[t], xy = stretch[count + t], yy = stretch[2 * count + t];
    const double c = maps(t, 0) * xx + maps(t, 1) * xy + maps(t, 2) * xy + maps(t, 3) * yy;
    const double s = maps(t, 2) * xx + maps(t, 3) * xy - maps(t, 0) * xy - maps(t, 1) * yy;
    const double length = std::hypot(c, s);
    if (!(length > 0.0)) continue;
    (*cosines)[t] = c / length;
    (*sines)[t] = s / length;
  }
}

}  // namespace

struct RigidBlend::Prepared {
  // A rest shape, the poses measured against it, and its prefactored problem.
  struct Model {
    Eigen::MatrixXd rotations;  // T x N
    Eigen::MatrixXd stretches;  // 3 T x N
    GradientFit fit;
  };

  Triangles triangles;
  VertexParts parts;
  std::vector<Points> poses;
  std::vector<Points> centroids;  // of each pose, a row per part
  Model rigid;
  Model paper;
  std::vector<double> mean_rotations;
  std::vector<int> turns;

  Points Linear(const Eigen::VectorXd& weights) const;
  Points Rigid(const Model& model, const Eigen::VectorXd& weights, ShearLimit shear_limit,
               int refits) const;
};

Result<RigidBlend> RigidBlend::Prepare(const CompatibleMesh& mesh, std::vector<int> turns) {
  const int num_poses = mesh.num_poses();
  turns.resize(turns.empty() ? num_poses : turns.size(), 0);
  if (static_cast<int>(turns.size()) != num_poses) {
    return Error{ErrorCode::kSizeMismatch,
                 std::to_string(turns.size()) + " whole turns were given for " +
                     std::to_string(num_poses) + " poses",
                 {}};
  }
  if (mesh.num_triangles() == 0) return Error{ErrorCode::kInternal, "the mesh is empty", {}};
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    const auto triangle = mesh.triangles.row(t);
    const bool has_area = std::any_of(mesh.poses.begin(), mesh.poses.end(), [&](const Points& p) {
      return Cross(p.row(triangle[0]), p.row(triangle[1]), p.row(triangle[2])) > 0.0;
    });
    if (!has_area) {
      return Error{ErrorCode::kInternal,
                   "triangle " + std::to_string(t) + " is degenerate in every pose",
                   {}};
    }
  }

  TriangleMaps rigid = MeasureTriangles(mesh, RestShape::kMean);
  TriangleMaps paper = MeasureTriangles(mesh, RestShape::kFirstPose);
  const std::vector<int> triangle_parts = EdgeConnectedParts(mesh.triangles);
  std::vector<double> mean_rotations;
  for (int i = 0; i < num_poses; ++i) {
    mean_rotations.push_back(WrapRotations(triangle_parts, i, turns[i], &rigid, &paper));
  }

  VertexParts parts = PartsOf(mesh.triangles, mesh.num_vertices());
  std::vector<Points> centroids;
  for (const Points& pose : mesh.poses) {
    centroids.push_back(PartCentroids(mesh.triangles, pose, parts));
  }

  const Eigen::VectorXd equal = Eigen::VectorXd::Ones(mesh.num_triangles());
  auto rigid_fit = TRY(GradientFit::Prepare(mesh.triangles, parts, rigid.gradients, rigid.areas));
  auto paper_fit = TRY(GradientFit::Prepare(mesh.triangles, parts, paper.gradients, equal));
  return RigidBlend(std::make_shared<const Prepared>(
      Prepared{mesh.triangles,
               std::move(parts),
               mesh.poses,
               std::move(centroids),
               {std::move(rigid.rotations), std::move(rigid.stretches), std::move(rigid_fit)},
               {std::move(paper.rotations), std::move(paper.stretches), std::move(paper_fit)},
               std::move(mean_rotations),
               std::move(turns)}));
}

Points RigidBlend::At(const Eigen::VectorXd& weights, const BlendOptions& options) const {
  switch (options.method) {
    case BlendMethod::kRigid:
      return prepared_->Rigid(prepared_->rigid, weights, options.shear_limit,
                              std::clamp(options.refits, 0, 3));
    case BlendMethod::kPaper:
      return prepared_->Rigid(prepared_->paper, weights, options.shear_limit, 0);
    case BlendMethod::kLinear:
      break;
  }
  return prepared_->Linear(weights);
}

Points RigidBlend::Prepared::Linear(const Eigen::VectorXd& weights) const {
  Points vertices = weights[0] * poses[0];
  for (std::size_t i = 1; i < poses.size(); ++i) vertices += weights[i] * poses[i];
  return vertices;
}

Points RigidBlend::Prepared::Rigid(const Model& model, const Eigen::VectorXd& weights,
                                   ShearLimit shear_limit, int refits) const {
  // alpha(w) = sum w_i alpha_i  and  S(w) = sum w'_i S_i.
  const Eigen::ArrayXd angles = model.rotations * weights;
  const Eigen::ArrayXd stretch = model.stretches * LimitedWeights(weights, shear_limit);
  Eigen::ArrayXd cosines = angles.cos(), sines = angles.sin();

  // V(w), then R_t = polar(J_t S_t) and V again.
  Eigen::MatrixXd maps;
  AssembleTargets(cosines, sines, stretch, &maps);
  Eigen::MatrixXd vertices = model.fit.Solve(maps);
  for (int refit = 0; refit < refits; ++refit) {
    model.fit.WeightedMaps(vertices, &maps);
    RefitRotations(maps, stretch, &cosines, &sines);
    AssembleTargets(cosines, sines, stretch, &maps);
    vertices = model.fit.Solve(maps);
  }

  // Each part's centroid goes to sum w_i c_i.
  Points shifts = -PartCentroids(triangles, vertices, parts);
  for (std::size_t i = 0; i < centroids.size(); ++i) shifts += weights[i] * centroids[i];
  Points placed = vertices;
  for (Eigen::Index v = 0; v < placed.rows(); ++v) placed.row(v) += shifts.row(parts.part_of[v]);
  return placed;
}

const std::vector<double>& RigidBlend::mean_rotations() const { return prepared_->mean_rotations; }

const std::vector<int>& RigidBlend::turns() const { return prepared_->turns; }

int CountFolds(const Triangles& triangles, const Points& vertices) {
  int folds = 0;
  for (const auto& triangle : triangles.rowwise()) {
    folds += Orientation(vertices.row(triangle[0]), vertices.row(triangle[1]),
                         vertices.row(triangle[2])) <= 0;
  }
  return folds;
}

}  // namespace posespace
