// SPDX-License-Identifier: Apache-2.0
#include "tests/interpolation/sample_meshes.h"

#include <cmath>
#include <map>
#include <numbers>

namespace posespace {
namespace {

CompatibleMesh MeshOf(const std::vector<Point>& rest,
                      const std::vector<std::array<int, 3>>& corners,
                      const std::vector<Deformation>& poses) {
  CompatibleMesh mesh;
  mesh.triangles.resize(static_cast<Eigen::Index>(corners.size()), 3);
  for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
    mesh.triangles.row(t) << corners[t][0], corners[t][1], corners[t][2];
  }
  for (const Deformation& pose : poses) {
    Points vertices(static_cast<Eigen::Index>(rest.size()), 2);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) vertices.row(v) = pose(rest[v]);
    mesh.poses.push_back(std::move(vertices));
  }
  return mesh;
}

Point Turned(double angle, const Point& p) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

}  // namespace

CompatibleMesh StripMesh(int columns, int rows, double side,
                         const std::vector<Deformation>& poses) {
  std::vector<Point> rest;
  for (int i = 0; i <= columns; ++i) {
    for (int j = 0; j <= rows; ++j) rest.emplace_back(i * side, (j - 0.5 * rows) * side);
  }
  std::vector<std::array<int, 3>> corners;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      const int a = i * (rows + 1) + j, b = a + rows + 1;
      corners.push_back({a, b, b + 1});
      corners.push_back({a, b + 1, a + 1});
    }
  }
  CompatibleMesh mesh = MeshOf(rest, corners, poses);
  std::vector<int> loop;
  for (int i = 0; i <= columns; ++i) loop.push_back(i * (rows + 1));
  for (int j = 1; j <= rows; ++j) loop.push_back(columns * (rows + 1) + j);
  for (int i = columns - 1; i >= 0; --i) loop.push_back(i * (rows + 1) + rows);
  for (int j = rows - 1; j > 0; --j) loop.push_back(j);
  mesh.boundary = {loop};
  return mesh;
}

CompatibleMesh AnnulusMesh(int spokes, int rings, const std::vector<Deformation>& poses) {
  std::vector<Point> rest;
  for (int i = 0; i < spokes; ++i) {
    for (int j = 0; j <= rings; ++j) {
      rest.push_back(Turned(2.0 * std::numbers::pi * i / spokes, {0.5 + 0.5 * j / rings, 0.0}));
    }
  }
  std::vector<std::array<int, 3>> corners;
  for (int i = 0; i < spokes; ++i) {
    for (int j = 0; j < rings; ++j) {
      const int a = i * (rings + 1) + j, b = (i + 1) % spokes * (rings + 1) + j;
      corners.push_back({a, a + 1, b + 1});
      corners.push_back({a, b + 1, b});
    }
  }
  return MeshOf(rest, corners, poses);
}

CompatibleMesh PlusMesh(int cells_per_unit, const std::vector<Deformation>& poses) {
  const int n = cells_per_unit;
  std::map<std::pair<int, int>, int> numbers;
  std::vector<Point> rest;
  const auto vertex = [&](int i, int j) {
    const auto [entry, is_new] = numbers.try_emplace({i, j}, static_cast<int>(rest.size()));
    if (is_new) rest.emplace_back(double(i) / n, double(j) / n);
    return entry->second;
  };
  std::vector<std::array<int, 3>> corners;
  for (int i = -4 * n; i < 4 * n; ++i) {
    for (int j = -4 * n; j < 4 * n; ++j) {
      if ((i < -n || i >= n) && (j < -n || j >= n)) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                d = vertex(i, j + 1);
      corners.push_back({a, b, c});
      corners.push_back({a, c, d});
    }
  }
  return MeshOf(rest, corners, poses);
}

Deformation Bent(double length, double angle) {
  return [=](const Point& p) -> Point {
    if (angle == 0.0) return p;
    const double radius = length / angle, at = p.x() / radius;
    return {(radius - p.y()) * std::sin(at), radius - (radius - p.y()) * std::cos(at)};
  };
}

Deformation Moved(double angle, const Point& shift) {
  return [=](const Point& p) -> Point { return Turned(angle, p) + shift; };
}

Point RolledUp(const Point& p) {
  const auto heading = [](double s) { return 5.0 * std::numbers::pi * std::pow(s / 40.0, 1.5); };
  Point at = Point::Zero();
  constexpr int kSteps = 2000;
  for (int k = 0; k < kSteps; ++k) {
    const double s = p.x() * (k + 0.5) / kSteps;
    at += Point(std::cos(heading(s)), std::sin(heading(s))) * p.x() / kSteps;
  }
  return at + p.y() * Point(-std::sin(heading(p.x())), std::cos(heading(p.x())));
}

Deformation WithLimbs(const std::array<double, 4>& angles, const std::array<double, 4>& lengths) {
  return [=](const Point& p) -> Point {
    for (int limb = 0; limb < 4; ++limb) {
      const double direction = 0.5 * std::numbers::pi * limb;
      Point along = Turned(-direction, p);
      if (!(along.x() > 1.0)) continue;
      along.x() = (along.x() - 1.0) * lengths[limb];
      const Point bent = Bent(3.0 * lengths[limb], angles[limb])(along);
      return Turned(direction, bent + Point(1.0, 0.0));
    }
    return p;
  };
}

std::vector<Deformation> RandomLimbs(int num_poses, double most, std::mt19937* random) {
  std::vector<Deformation> poses;
  for (int i = 0; i < num_poses; ++i) {
    std::array<double, 4> angles, lengths;
    for (double& angle : angles) angle = Uniform(-most, most, random);
    for (double& length : lengths) length = Uniform(0.9, 1.1, random);
    poses.push_back(WithLimbs(angles, lengths));
  }
  return poses;
}

double Uniform(double low, double high, std::mt19937* random) {
  return low + (high - low) * ((*random)() / 4294967296.0);
}

Eigen::VectorXd RandomWeights(int count, std::mt19937* random) {
  Eigen::VectorXd weights(count);
  for (double& weight : weights) weight = -std::log(1.0 - Uniform(0.0, 1.0, random));
  return weights / weights.sum();
}

double EdgeDistortion(const CompatibleMesh& mesh, const Points& vertices,
                      const Eigen::VectorXd& weights) {
  const Edges edges = EdgesOf(mesh.triangles);
  double sum = 0.0;
  for (const auto& edge : edges.rowwise()) {
    double expected = 0.0;
    for (int i = 0; i < mesh.num_poses(); ++i) {
      expected += weights[i] * (mesh.poses[i].row(edge[0]) - mesh.poses[i].row(edge[1])).norm();
    }
    const double length = (vertices.row(edge[0]) - vertices.row(edge[1])).norm();
    sum += std::pow(std::log(length / expected), 2);
  }
  return std::sqrt(sum / static_cast<double>(edges.rows()));
}

double Apart(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

}  // namespace posespace
