// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/eigen_blend.h"

#include <cmath>

#include "interpolation/shear_limit.h"

namespace posespace {

EigenBlend::EigenBlend(const RigidModel& model) : model_(model) {
  const auto& [gradients, areas, masses, rotations, stretches] = model.rigid;
  const Eigen::Index num_triangles = model.triangles.rows();
  const auto num_vertices = static_cast<Eigen::Index>(model.parts.part_of.size());
  std::vector<Eigen::Triplet<double>> gradient, divergence;
  for (Eigen::Index t = 0; t < num_triangles; ++t) {
    for (int c = 0; c < 3; ++c) {
      for (int axis = 0; axis < 2; ++axis) {
        const double g = gradients(t, 2 * c + axis);
        gradient.emplace_back(axis * num_triangles + t, model.triangles(t, c), g);
        divergence.emplace_back(model.triangles(t, c), axis * num_triangles + t, masses[t] * g);
      }
    }
  }
  gradient_.resize(2 * num_triangles, num_vertices);
  gradient_.setFromTriplets(gradient.begin(), gradient.end());
  divergence_.resize(num_vertices, 2 * num_triangles);
  divergence_.setFromTriplets(divergence.begin(), divergence.end());
  factor_.compute(NormalMatrix(model.triangles, model.parts, gradients, masses));
  targets_.resize(2 * num_triangles, 2);
}

void EigenBlend::AssembleAndSolve() {
  const Eigen::Index n = model_.triangles.rows();
  const auto xx = stretch_.head(n), xy = stretch_.segment(n, n), yy = stretch_.tail(n);
  targets_.col(0).head(n).array() = cosines_ * xx - sines_ * xy;
  targets_.col(0).tail(n).array() = cosines_ * xy - sines_ * yy;
  targets_.col(1).head(n).array() = sines_ * xx + cosines_ * xy;
  targets_.col(1).tail(n).array() = sines_ * xy + cosines_ * yy;
  right_.noalias() = divergence_ * targets_;
  vertices_ = factor_.solve(right_);
}

void EigenBlend::RefitRotations() {
  const Eigen::Index n = model_.triangles.rows();
  const auto xx = stretch_.head(n), xy = stretch_.segment(n, n), yy = stretch_.tail(n);
  maps_.noalias() = gradient_ * vertices_;
  const auto jxx = maps_.col(0).head(n).array(), jxy = maps_.col(0).tail(n).array();
  const auto jyx = maps_.col(1).head(n).array(), jyy = maps_.col(1).tail(n).array();
  cosines_ = jxx * xx + (jxy + jyx) * xy + jyy * yy;
  sines_ = jyx * xx + (jyy - jxx) * xy - jxy * yy;
  angles_ = (cosines_.square() + sines_.square()).sqrt();
  cosines_ /= angles_;
  sines_ /= angles_;
}

int EigenBlend::Solve(const Eigen::VectorXd& weights, int refits) {
  angles_.resize(model_.triangles.rows());
  stretch_.resize(3 * model_.triangles.rows());
  angles_.matrix().noalias() = model_.rigid.rotations * weights;
  stretch_.matrix().noalias() = model_.rigid.stretches * LimitedWeights(weights, ShearLimit::kBand);
  cosines_ = angles_.cos();
  sines_ = angles_.sin();
  AssembleAndSolve();
  for (int refit = 0; refit < refits; ++refit) {
    RefitRotations();
    AssembleAndSolve();
  }

  // The area centroid to sum w_i c_i; a mesh of one part, which no bench folds away.
  Point moment = Point::Zero();
  double area = 0.0;
  int folds = 0;
  for (Eigen::Index t = 0; t < model_.triangles.rows(); ++t) {
    const Point a = vertices_.row(model_.triangles(t, 0)),
                b = vertices_.row(model_.triangles(t, 1)),
                c = vertices_.row(model_.triangles(t, 2));
    const double cross = Cross(a, b, c);
    area += cross;
    moment += cross * (a + b + c);
    folds += !(cross > 0.0);
  }
  Point shift = -moment / (3.0 * area);
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    shift += weights[i] * model_.centroids[i].row(0).transpose();
  }
  placed_ = (vertices_.rowwise() + shift.transpose()).cast<float>();
  return folds;
}

}  // namespace posespace
