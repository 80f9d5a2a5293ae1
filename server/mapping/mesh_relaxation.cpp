// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_relaxation.h"

#include <Eigen/LU>
#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include "mapping/triangle_quality.h"

namespace posespace {
namespace {

// The energy of one triangle.  Higher powers would lift the worst angles at the cost of the median.
double Energy(double distortion) { return distortion * distortion; }

struct StarQuality {
  double energy = 0.0;
  double sharpest = 0.0;

  void Add(const Point& a, const Point& b, const Point& c) {
    energy += Energy(Distortion(a, b, c));
    sharpest = std::max(sharpest, Sharpness(a, b, c));
  }
};

using Sides = std::vector<std::pair<int, int>>;  // (b, c) of each triangle (v, b, c)

Sides SidesAround(const EditableMesh& mesh, int v) {
  Sides sides;
  for (const int t : mesh.TrianglesAt(v)) {
    const Triangle& corners = mesh.At(t);
    const int k = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
    sides.emplace_back(corners[(k + 1) % 3], corners[(k + 2) % 3]);
  }
  return sides;
}

StarQuality QualityAt(const EditableMesh& mesh, int pose, const Sides& sides, const Point& at) {
  StarQuality quality;
  for (const auto& [b, c] : sides) quality.Add(at, mesh.At(pose, b), mesh.At(pose, c));
  return quality;
}

// The Newton step of the star's energy at v, or the way to the middle of its link where the energy
// has no useful derivatives.
Point Step(const EditableMesh& mesh, int pose, const Sides& sides, const Point& at) {
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  Point middle = Point::Zero();
  for (const auto& [b_index, c_index] : sides) {
    const Point& b = mesh.At(pose, b_index);
    const Point& c = mesh.At(pose, c_index);
    middle += b;
    // q = k S / A with S the sum of squared sides, A the doubled area.
    const double area = Cross(at, b, c);
    const double sides_sum =
        (at - b).squaredNorm() + (at - c).squaredNorm() + (b - c).squaredNorm();
    const double k = 1.0 / (2.0 * std::numbers::sqrt3 * area);
    const double q = k * sides_sum;
    const Eigen::Vector2d area_gradient(b.y() - c.y(), c.x() - b.x());
    const Eigen::Vector2d sum_gradient = 4.0 * at - 2.0 * (b + c);
    const Eigen::Vector2d relative = area_gradient / area;
    const Eigen::Vector2d q_gradient = k * sum_gradient - q * relative;
    Eigen::Matrix2d q_hessian = 4.0 * k * Eigen::Matrix2d::Identity();
    q_hessian -= relative * q_gradient.transpose() + q_gradient * relative.transpose();
    gradient += 2.0 * q * q_gradient;
    hessian += 2.0 * (q * q_hessian + q_gradient * q_gradient.transpose());
  }
  const Point step = -hessian.inverse() * gradient;
  if (step.allFinite() && step.dot(gradient) < 0.0) return step;
  return middle / static_cast<double>(sides.size()) - at;
}

bool SmoothVertex(EditableMesh& mesh, int pose, int v, const Sides& sides, double sharpest) {
  constexpr double kLeastGain = 1e-4;
  const Point from = mesh.At(pose, v);
  const StarQuality before = QualityAt(mesh, pose, sides, from);
  const double allowed = std::max(before.sharpest, sharpest);
  const Point step = Step(mesh, pose, sides, from);
  for (const double fraction : {1.0, 0.5, 0.25, 0.1, 0.03}) {
    const Point to = from + fraction * step;
    const StarQuality after = QualityAt(mesh, pose, sides, to);
    if (!(after.energy < before.energy * (1.0 - kLeastGain)) || after.sharpest > allowed) continue;
    mesh.Move(pose, v, to);
    const bool valid = std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
      return mesh.IsPositive(pose, v, side.first, side.second);
    });
    if (valid) return true;
    mesh.Move(pose, v, from);
  }
  return false;
}

bool FlipEdge(EditableMesh& mesh, int a, int b, double sharpest) {
  constexpr double kLeastGain = 1e-3;
  const int c = mesh.Opposite(a, b), d = mesh.Opposite(b, a);
  if (c < 0 || d < 0 || mesh.HasEdge(c, d)) return false;
  StarQuality before, after;
  for (int pose = 0; pose < mesh.num_poses(); ++pose) {
    const Point &pa = mesh.At(pose, a), &pb = mesh.At(pose, b);
    const Point &pc = mesh.At(pose, c), &pd = mesh.At(pose, d);
    before.Add(pa, pb, pc);
    before.Add(pb, pa, pd);
    after.Add(pc, pa, pd);
    after.Add(pd, pb, pc);
  }
  if (!(after.energy < before.energy * (1.0 - kLeastGain))) return false;
  if (after.sharpest > std::max(before.sharpest, sharpest)) return false;
  if (!mesh.IsPositiveInAllPoses(c, a, d) || !mesh.IsPositiveInAllPoses(d, b, c)) return false;
  mesh.Flip(a, b);
  return true;
}

}  // namespace

int SmoothVertices(EditableMesh& mesh, double sharpest, Progress* progress) {
  int moved = 0;
  for (int v = 0; v < mesh.num_vertices(); ++v) {
    if (IsCancelled(progress)) break;
    if (!mesh.IsLive(v) || mesh.IsFixed(v)) continue;
    const Sides sides = SidesAround(mesh, v);
    bool any = false;
    for (int pose = 0; pose < mesh.num_poses(); ++pose) {
      any = SmoothVertex(mesh, pose, v, sides, sharpest) || any;
    }
    moved += any ? 1 : 0;
  }
  return moved;
}

int FlipEdges(EditableMesh& mesh, double sharpest, Progress* progress) {
  int flips = 0;
  std::vector<std::pair<int, int>> open = mesh.InteriorEdges();
  while (!open.empty() && !IsCancelled(progress)) {
    std::vector<std::pair<int, int>> next;
    for (const auto& [a, b] : open) {
      if (IsCancelled(progress)) break;
      const int c = mesh.Opposite(a, b), d = mesh.Opposite(b, a);
      if (!FlipEdge(mesh, a, b, sharpest)) continue;
      ++flips;
      for (const int end : {a, b}) {
        for (const int apex : {c, d}) next.push_back(std::minmax(end, apex));
      }
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    open = std::move(next);
  }
  return flips;
}

void Relax(EditableMesh& mesh, int rounds, int sweeps, double sharpest, Progress* progress) {
  for (int round = 0; round < rounds && !IsCancelled(progress); ++round) {
    int changes = FlipEdges(mesh, sharpest, progress);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      changes += SmoothVertices(mesh, sharpest, progress);
    }
    if (changes == 0) break;
  }
}

}  // namespace posespace
