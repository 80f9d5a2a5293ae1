// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_MAPPING_COMPATIBLE_MESH_CHECK_H_
#define POSESPACE_TESTS_MAPPING_COMPATIBLE_MESH_CHECK_H_

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/polygon.h"

// Checks of a compatible mesh that share no code with the kernel's own.

namespace posespace {

// The sign of cross(b - a, c - a), by Shewchuk's expansions: all products split without error, all
// terms summed without error.
inline int ExactOrientation(const Point& a, const Point& b, const Point& c) {
  std::vector<double> expansion;  // of growing magnitude, not overlapping
  const auto add = [&](double term) {
    for (double& part : expansion) {
      const double sum = term + part, term_part = sum - part;
      const double lost = (part - (sum - term_part)) + (term - term_part);
      term = sum;
      part = lost;
    }
    expansion.push_back(term);
  };
  const auto add_product = [&](double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  };
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    add_product(p.x(), q.y());
    add_product(-p.y(), q.x());
  }
  for (auto part = expansion.rbegin(); part != expansion.rend(); ++part) {
    if (*part != 0.0) return *part > 0.0 ? 1 : -1;
  }
  return 0;
}

// A mesh that triangulates the disc within its one boundary loop, positively in every pose, and
// whose triangles add up to the area of that loop.
MATCHER(IsACompatibleDisc, "is a disc with the same positive triangles in every pose") {
  const CompatibleMesh& mesh = arg;
  const int num_vertices = mesh.num_vertices();
  // Each side of a triangle has at most one triangle to its left; sides without one to their right
  // are the boundary loop.
  std::map<std::pair<int, int>, int> left_of;
  std::set<int> used;
  for (int t = 0; t < mesh.num_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = mesh.triangles(t, k), to = mesh.triangles(t, (k + 1) % 3);
      if (from < 0 || from >= num_vertices || !left_of.emplace(std::pair(from, to), t).second) {
        *result_listener << "side " << from << " -> " << to << " is not in one triangle";
        return false;
      }
      used.insert(from);
    }
  }
  if (static_cast<int>(used.size()) != num_vertices) {
    *result_listener << "a vertex is in no triangle";
    return false;
  }
  if (mesh.boundary.size() != 1) {
    *result_listener << "there are " << mesh.boundary.size() << " boundary loops";
    return false;
  }
  const std::vector<int>& loop = mesh.boundary[0];
  std::set<std::pair<int, int>> rim;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    rim.emplace(loop[k], loop[(k + 1) % loop.size()]);
  }
  int edges = 0;
  for (const auto& [side, t] : left_of) {
    const bool open = !left_of.contains({side.second, side.first});
    if (open != rim.contains(side)) {
      *result_listener << "side " << side.first << " -> " << side.second << " is "
                       << (open ? "open but not" : "closed but") << " in the boundary loop";
      return false;
    }
    edges += open || side.first < side.second ? 1 : 0;
  }
  if (rim.size() != loop.size() || num_vertices - edges + mesh.num_triangles() != 1) {
    *result_listener << "Euler characteristic " << num_vertices - edges + mesh.num_triangles();
    return false;
  }
  for (int i = 0; i < mesh.num_poses(); ++i) {
    const Points& pose = mesh.poses[i];
    double area = 0.0;
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      const Point a = pose.row(mesh.triangles(t, 0)), b = pose.row(mesh.triangles(t, 1)),
                  c = pose.row(mesh.triangles(t, 2));
      if (ExactOrientation(a, b, c) <= 0) {
        *result_listener << "triangle " << t << " is not positive in pose " << i;
        return false;
      }
      area += 0.5 * Cross(a, b, c);
    }
    Points ring(static_cast<Eigen::Index>(loop.size()), 2);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      ring.row(static_cast<Eigen::Index>(k)) = pose.row(loop[k]);
    }
    if (!IsSimple(ring) || std::abs(area - SignedArea(ring)) > 1e-9 * area) {
      *result_listener << "pose " << i << " has area " << area << " within a rim of "
                       << SignedArea(ring) << (IsSimple(ring) ? "" : " that crosses itself");
      return false;
    }
  }
  return true;
}

// The smallest angle of each triangle in each pose, sorted, degrees.
inline std::vector<double> SmallestAngles(const CompatibleMesh& mesh) {
  std::vector<double> angles;
  for (const Points& pose : mesh.poses) {
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      angles.push_back(180.0 / std::numbers::pi *
                       MinAngle(pose.row(mesh.triangles(t, 0)), pose.row(mesh.triangles(t, 1)),
                                pose.row(mesh.triangles(t, 2))));
    }
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_MAPPING_COMPATIBLE_MESH_CHECK_H_
