// SPDX-License-Identifier: Apache-2.0
// RigidBlend against a blend written down a second time, another way: other rest triangles
// (Cholesky factors of the metrics), rotations by singular values, unwrapping along turning edges,
// and a dense QR of the stacked equations.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <map>
#include <numbers>

#include "geometry/polygon.h"
#include "interpolation/rigid_blend.h"
#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

using Eigen::Matrix2d;

Matrix2d EdgeMatrix(const Points& pose, const Eigen::RowVector3i& t) {
  Matrix2d edges;
  edges.col(0) = (pose.row(t[0]) - pose.row(t[2])).transpose();
  edges.col(1) = (pose.row(t[1]) - pose.row(t[2])).transpose();
  return edges;
}

Matrix2d NearestRotation(const Matrix2d& map) {
  const Eigen::JacobiSVD<Matrix2d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

double AngleOf(const Matrix2d& rotation) { return std::atan2(rotation(1, 0), rotation(0, 0)); }

double NearestTo(double reference, double angle) {
  return reference + std::remainder(angle - reference, 2.0 * std::numbers::pi);
}

// By how much each triangle of `pose` turns against `base`: passed on through the turning of shared
// edges, from which neither triangle's rotation is a quarter turn away.
std::vector<double> TurnsOfTriangles(const Triangles& triangles, const Points& base,
                                     const Points& pose) {
  std::map<std::pair<int, int>, std::vector<int>> beside;
  for (int t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      beside[std::minmax(triangles(t, k), triangles(t, (k + 1) % 3))].push_back(t);
    }
  }
  const auto angle_of = [&](int t) {
    const Eigen::RowVector3i row = triangles.row(t);
    return AngleOf(NearestRotation(EdgeMatrix(pose, row) * EdgeMatrix(base, row).inverse()));
  };
  std::vector<double> turn(static_cast<std::size_t>(triangles.rows()), NAN);
  turn[0] = angle_of(0);
  std::vector<int> stack{0};
  while (!stack.empty()) {
    const int t = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const int a = triangles(t, k), b = triangles(t, (k + 1) % 3);
      const Point before = base.row(b) - base.row(a), after = pose.row(b) - pose.row(a);
      const double edge_turn =
          NearestTo(turn[t], std::atan2(after.y(), after.x()) - std::atan2(before.y(), before.x()));
      for (const int other : beside[std::minmax(a, b)]) {
        if (!std::isnan(turn[other])) continue;
        turn[other] = NearestTo(edge_turn, angle_of(other));
        stack.push_back(other);
      }
    }
  }
  return turn;
}

struct Variant {
  bool mean_rest;
  ShearLimit limit;
  int refits;
};

Points DenseBlend(const CompatibleMesh& mesh, const Eigen::VectorXd& weights,
                  const Variant& variant) {
  const int num_triangles = mesh.num_triangles(), num_vertices = mesh.num_vertices(),
            num_poses = mesh.num_poses();
  const Eigen::VectorXd limited = LimitedWeights(weights, variant.limit);

  std::vector<std::vector<double>> turns;
  for (const Points& pose : mesh.poses) {
    turns.push_back(TurnsOfTriangles(mesh.triangles, mesh.poses[0], pose));
  }

  std::vector<Matrix2d> inverse_rest, stretch, rotation;
  std::vector<double> area;
  Eigen::MatrixXd angles(num_triangles, num_poses);
  for (int t = 0; t < num_triangles; ++t) {
    const Eigen::RowVector3i row = mesh.triangles.row(t);
    Matrix2d rest = EdgeMatrix(mesh.poses[0], row);
    if (variant.mean_rest) {
      Matrix2d metric = Matrix2d::Zero();
      for (const Points& pose : mesh.poses) {
        metric += EdgeMatrix(pose, row).transpose() * EdgeMatrix(pose, row) / num_poses;
      }
      rest = metric.llt().matrixU();
    }
    inverse_rest.push_back(rest.inverse());
    area.push_back(0.5 * rest.determinant());
    Matrix2d sum = Matrix2d::Zero();
    // The rest triangle is turned anyhow: bring its frame to pose 0's, where turns are measured.
    const Matrix2d frame = NearestRotation(EdgeMatrix(mesh.poses[0], row) * inverse_rest[t]);
    for (int i = 0; i < num_poses; ++i) {
      const Matrix2d map = EdgeMatrix(mesh.poses[i], row) * inverse_rest[t] * frame.transpose();
      const Matrix2d turned = NearestRotation(map);
      angles(t, i) = NearestTo(turns[i][t], AngleOf(turned));
      sum += limited[i] * turned.transpose() * map;
    }
    stretch.push_back(sum);
    inverse_rest[t] = inverse_rest[t] * frame.transpose();
  }
  const Eigen::Map<const Eigen::VectorXd> areas(area.data(), num_triangles);
  for (int i = 0; i < num_poses; ++i) {
    const double mean = areas.dot(angles.col(i)) / areas.sum();
    angles.col(i).array() += NearestTo(0.0, mean) - mean;
  }
  for (int t = 0; t < num_triangles; ++t) {
    const double angle = angles.row(t).dot(weights);
    rotation.push_back(Eigen::Rotation2Dd(angle).toRotationMatrix());
  }

  // sqrt(mass) J_t V = sqrt(mass) target, and vertex 0 at 0.
  std::vector<double> root_mass(num_triangles, 1.0);
  for (int t = 0; variant.mean_rest && t < num_triangles; ++t) {
    double factor = 1.0;
    for (const Points& pose : mesh.poses) {
      double whole = 0.0;
      for (const auto& row : mesh.triangles.rowwise()) {
        whole += 0.5 * EdgeMatrix(pose, row).determinant();
      }
      const double share = 0.5 * EdgeMatrix(pose, mesh.triangles.row(t)).determinant() / whole;
      factor = std::max(factor, std::pow(area[t] / areas.sum() / share, 2.0 / 3.0));
    }
    root_mass[t] = std::sqrt(area[t] * std::min(factor, 16.0));
  }
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(2 * num_triangles + 1, num_vertices);
  for (int t = 0; t < num_triangles; ++t) {
    const double root = root_mass[t];
    for (int k = 0; k < 2; ++k) {
      for (int e = 0; e < 2; ++e) {
        equations(2 * t + k, mesh.triangles(t, e)) += root * inverse_rest[t](e, k);
        equations(2 * t + k, mesh.triangles(t, 2)) -= root * inverse_rest[t](e, k);
      }
    }
  }
  equations(2 * num_triangles, 0) = 1.0;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(equations);
  Eigen::MatrixXd vertices;
  for (int round = 0; round <= variant.refits; ++round) {
    Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(2 * num_triangles + 1, 2);
    for (int t = 0; t < num_triangles; ++t) {
      if (round > 0) {
        const Points points = vertices;
        rotation[t] = NearestRotation(EdgeMatrix(points, mesh.triangles.row(t)) * inverse_rest[t] *
                                      stretch[t]);
      }
      targets.middleRows(2 * t, 2) = root_mass[t] * (rotation[t] * stretch[t]).transpose();
    }
    vertices = qr.solve(targets);
  }

  // The outline's area centroid to the mean of the poses'.
  const auto centroid = [&](const Points& points) {
    Points ring(static_cast<Eigen::Index>(mesh.boundary[0].size()), 2);
    for (Eigen::Index k = 0; k < ring.rows(); ++k) ring.row(k) = points.row(mesh.boundary[0][k]);
    return AreaCentroid(ring);
  };
  Points placed = vertices;
  Point shift = -centroid(placed);
  for (int i = 0; i < num_poses; ++i) shift += weights[i] * centroid(mesh.poses[i]);
  placed.rowwise() += shift.transpose();
  return placed;
}

TEST(RigidBlend, AgreesWithADenseLeastSquaresSolve) {
  const auto wave = [](const Point& p) -> Point {
    return {p.x() + 0.3 * std::sin(p.y()), 1.3 * p.y() + 0.5 * std::sin(p.x())};
  };
  const CompatibleMesh mesh = StripMesh(
      10, 3, 1.0,
      {Bent(10.0, 0.5), Bent(10.0, -2.0), wave, Bent(10.0, 5.0), [&](const Point& p) -> Point {
         return Moved(2.0, {4, 5})(wave(p));
       }});
  for (const Points& pose : mesh.poses) ASSERT_EQ(CountFolds(mesh.triangles, pose), 0);
  const auto blend = RigidBlend::Prepare(mesh);
  ASSERT_TRUE(blend);
  std::mt19937 random(5);
  for (int k = 0; k < 12; ++k) {
    Eigen::VectorXd weights = 1.5 * RandomWeights(5, &random);
    weights[k % 5] -= 0.5;
    for (const int refits : {0, 1, 2, 3}) {
      for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite}) {
        EXPECT_LT(Apart(blend->At(weights, {.shear_limit = limit, .refits = refits}),
                        DenseBlend(mesh, weights, {true, limit, refits})),
                  1e-8);
      }
    }
    EXPECT_LT(Apart(blend->At(weights,
                              {.method = BlendMethod::kPaper, .shear_limit = ShearLimit::kHermite}),
                    DenseBlend(mesh, weights, {false, ShearLimit::kHermite, 0})),
              1e-8);
  }
}

}  // namespace
}  // namespace posespace
