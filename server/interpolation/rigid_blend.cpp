// SPDX-License-Identifier: Apache-2.0
#include "interpolation/rigid_blend.h"

#include <algorithm>
#include <cmath>

#include "geometry/polygon.h"
#include "interpolation/fold_repair.h"
#include "interpolation/gradient_fit.h"

namespace posespace {
namespace {

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

// f of a symmetric 2 x 2 matrix (xx, xy, yy): of its eigenvalues, its axes kept.
template <typename Function>
Eigen::Array3d OfSymmetric(const Eigen::Array3d& matrix, Function f) {
  const double mean = 0.5 * (matrix[0] + matrix[2]), half = 0.5 * (matrix[0] - matrix[2]);
  const double radius = std::hypot(half, matrix[1]);
  const double high = f(mean + radius), low = f(mean - radius);
  const double slope = radius > 0.0 ? 0.5 * (high - low) / radius : 0.0;
  const double middle = 0.5 * (high + low);
  return {middle + slope * half, slope * matrix[1], middle - slope * half};
}

// The blended stretches, 3 T: all xx, then all xy, then all yy.
Eigen::ArrayXd MixStretches(const Eigen::MatrixXd& stretches, const Eigen::VectorXd& weights,
                            StretchBlend blend) {
  if (blend == StretchBlend::kLinear) return stretches * weights;
  static constexpr double kLeast = 1e-12;  // of a stretch, so that its logarithm is finite
  const Eigen::Index count = stretches.rows() / 3;
  Eigen::ArrayXd mixed(stretches.rows());
  const auto of_triangle = [count](const auto& column, Eigen::Index t) {
    return Eigen::Array3d(column[t], column[count + t], column[2 * count + t]);
  };
  for (Eigen::Index t = 0; t < count; ++t) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const Eigen::Array3d stretch = of_triangle(stretches.col(i), t);
      sum += weights[i] *
             (blend == StretchBlend::kLog
                  ? OfSymmetric(stretch, [](double x) { return std::log(std::max(x, kLeast)); })
                  : OfSymmetric(stretch, [](double x) { return x * x; }));
    }
    const Eigen::Array3d root =
        blend == StretchBlend::kLog
            ? OfSymmetric(sum, [](double x) { return std::exp(x); })
            : OfSymmetric(sum, [](double x) { return std::sqrt(std::max(x, 0.0)); });
    for (int k = 0; k < 3; ++k) mixed[k * count + t] = root[k];
  }
  return mixed;
}

// Orientation(a, b, c) > 0, without asking it where double rounding cannot change the answer.
bool IsPositive(const Point& a, const Point& b, const Point& c) {
  const double left = (b.x() - a.x()) * (c.y() - a.y()), right = (b.y() - a.y()) * (c.x() - a.x());
  constexpr double kRounding = 4e-15;  // several times what it can be
  const double doubt = kRounding * (std::abs(left) + std::abs(right));
  if (left - right > doubt) return true;
  if (right - left > doubt) return false;
  return Orientation(a, b, c) > 0;
}

}  // namespace

struct RigidBlend::Prepared {
  RigidModel model;
  GradientFit rigid_fit;
  GradientFit paper_fit;

  Points Linear(const Eigen::VectorXd& weights) const;
  Points Rigid(const TriangleMaps& maps, const GradientFit& fit, const Eigen::VectorXd& weights,
               const BlendOptions& options) const;
  Points Blended(const Eigen::VectorXd& weights, const BlendOptions& options) const;
  void Place(const Eigen::VectorXd& weights, Points* vertices) const;
};

Result<RigidBlend> RigidBlend::Prepare(const CompatibleMesh& mesh, std::vector<int> turns) {
  RigidModel model = TRY(MeasurePoses(mesh, std::move(turns)));
  const Eigen::VectorXd equal = Eigen::VectorXd::Ones(mesh.num_triangles());
  auto rigid_fit = TRY(
      GradientFit::Prepare(mesh.triangles, model.parts, model.rigid.gradients, model.rigid.masses));
  auto paper_fit =
      TRY(GradientFit::Prepare(mesh.triangles, model.parts, model.paper.gradients, equal));
  return RigidBlend(std::make_shared<const Prepared>(
      Prepared{std::move(model), std::move(rigid_fit), std::move(paper_fit)}));
}

Points RigidBlend::At(const Eigen::VectorXd& weights, const BlendOptions& options) const {
  Points vertices = prepared_->Blended(weights, options);
  if (options.anchor) Hold(*options.anchor, weights, &vertices);
  return vertices;
}

Points RigidBlend::Prepared::Blended(const Eigen::VectorXd& weights,
                                     const BlendOptions& options) const {
  switch (options.method) {
    case BlendMethod::kRigid:
      return Rigid(model.rigid, rigid_fit, weights, options);
    case BlendMethod::kPaper:
      return Rigid(model.paper, paper_fit, weights,
                   {.shear_limit = options.shear_limit, .refits = 0});
    case BlendMethod::kLinear:
      break;
  }
  return Linear(weights);
}

Points RigidBlend::Prepared::Linear(const Eigen::VectorXd& weights) const {
  Points vertices = weights[0] * model.poses[0];
  for (std::size_t i = 1; i < model.poses.size(); ++i) vertices += weights[i] * model.poses[i];
  return vertices;
}

Points RigidBlend::Prepared::Rigid(const TriangleMaps& maps, const GradientFit& fit,
                                   const Eigen::VectorXd& weights,
                                   const BlendOptions& options) const {
  // alpha(w) = sum w_i alpha_i  and  S(w) = sum w'_i S_i.
  const Eigen::ArrayXd angles = maps.rotations * weights;
  const Eigen::ArrayXd stretch =
      MixStretches(maps.stretches, LimitedWeights(weights, options.shear_limit), options.stretch);
  Eigen::ArrayXd cosines = angles.cos(), sines = angles.sin();

  // V(w), then R_t = polar(J_t S_t) and V again.
  Eigen::MatrixXd targets;
  AssembleTargets(cosines, sines, stretch, &targets);
  Points vertices = fit.Solve(targets);
  for (int refit = 0; refit < std::clamp(options.refits, 0, 3); ++refit) {
    fit.WeightedMaps(vertices, &targets);
    RefitRotations(targets, stretch, &cosines, &sines);
    AssembleTargets(cosines, sines, stretch, &targets);
    vertices = fit.Solve(targets);
  }

  Place(weights, &vertices);
  return vertices;
}

// Each part's centroid goes to sum w_i c_i.
void RigidBlend::Prepared::Place(const Eigen::VectorXd& weights, Points* vertices) const {
  Points shifts = -PartCentroids(model.triangles, *vertices, model.parts);
  for (std::size_t i = 0; i < model.centroids.size(); ++i) {
    shifts += weights[i] * model.centroids[i];
  }
  for (Eigen::Index v = 0; v < vertices->rows(); ++v) {
    vertices->row(v) += shifts.row(model.parts.part_of[v]);
  }
}

void RigidBlend::Hold(const MeshPoint& anchor, const Eigen::VectorXd& weights,
                      Points* vertices) const {
  const RigidModel& model = prepared_->model;
  const Point now =
      anchor.In(model.triangles, [&](int v) -> Point { return vertices->row(v).transpose(); });
  const Point wanted = AnchorPlace(anchor, model.triangles, model.poses,
                                   {weights.data(), static_cast<std::size_t>(weights.size())});
  vertices->rowwise() += (wanted - now).transpose();
}

Points RigidBlend::Mended(const Points& vertices, const Eigen::VectorXd& weights,
                          const BlendOptions& options) const {
  const auto& [model, rigid_fit, paper_fit] = *prepared_;
  const bool is_paper = options.method == BlendMethod::kPaper;
  const TriangleMaps& maps = is_paper ? model.paper : model.rigid;
  const GradientFit& fit = is_paper ? paper_fit : rigid_fit;
  const Eigen::ArrayXd stretch =
      MixStretches(maps.stretches, LimitedWeights(weights, options.shear_limit),
                   is_paper ? StretchBlend::kLinear : options.stretch);

  // The target triangle is the rest triangle, stretched: J = K S.
  const Eigen::Index count = maps.areas.size();
  TargetTriangles targets{maps.gradients, maps.areas};
  for (Eigen::Index t = 0; t < count; ++t) {
    const double xx = stretch[t], xy = stretch[count + t], yy = stretch[2 * count + t];
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0 && xx > 0.0)) return vertices;
    for (int k = 0; k < 3; ++k) {
      const double gx = maps.gradients(t, 2 * k), gy = maps.gradients(t, 2 * k + 1);
      targets.gradients(t, 2 * k) = (yy * gx - xy * gy) / determinant;
      targets.gradients(t, 2 * k + 1) = (xx * gy - xy * gx) / determinant;
    }
    targets.areas[t] *= determinant;
  }
  Points mended = Unfolded(model.triangles, targets, vertices,
                           [&fit](const Eigen::MatrixXd& right) { return fit.SolveNormal(right); });
  prepared_->Place(weights, &mended);
  if (options.anchor) Hold(*options.anchor, weights, &mended);
  return mended;
}

const std::vector<double>& RigidBlend::mean_rotations() const {
  return prepared_->model.mean_rotations;
}

const std::vector<int>& RigidBlend::turns() const { return prepared_->model.turns; }

const RigidModel& RigidBlend::model() const { return prepared_->model; }

int CountFolds(const Triangles& triangles, const Points& vertices) {
  int folds = 0;
  for (const auto& triangle : triangles.rowwise()) {
    folds += !IsPositive(vertices.row(triangle[0]), vertices.row(triangle[1]),
                         vertices.row(triangle[2]));
  }
  return folds;
}

int CountFolds(const Triangles& triangles, std::span<const float> coordinates) {
  const auto point = [&](int vertex) {
    const std::size_t at = 2 * static_cast<std::size_t>(vertex);
    return Point(coordinates[at], coordinates[at + 1]);
  };
  int folds = 0;
  for (const auto& triangle : triangles.rowwise()) {
    folds += !IsPositive(point(triangle[0]), point(triangle[1]), point(triangle[2]));
  }
  return folds;
}

}  // namespace posespace
