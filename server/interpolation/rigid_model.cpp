// SPDX-License-Identifier: Apache-2.0
#include "interpolation/rigid_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace posespace {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

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

}  // namespace

Points PartCentroids(const Triangles& triangles, const Points& vertices, const VertexParts& parts) {
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
    if (moment.signed_area > kLeastSignedArea * moment.absolute_area) {
      centroid += moment.signed_sum / moment.signed_area;
    } else if (moment.absolute_area > 0.0) {
      centroid += moment.absolute_sum / moment.absolute_area;
    }
    centroids.row(part) = centroid;
  }
  return centroids;
}

Result<RigidModel> MeasurePoses(const CompatibleMesh& mesh, std::vector<int> turns) {
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
  return RigidModel{mesh.triangles,
                    std::move(parts),
                    mesh.poses,
                    std::move(centroids),
                    std::move(rigid),
                    std::move(paper),
                    std::move(mean_rotations),
                    std::move(turns)};
}

}  // namespace posespace
