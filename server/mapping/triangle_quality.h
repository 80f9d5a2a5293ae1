// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_TRIANGLE_QUALITY_H_
#define POSESPACE_MAPPING_TRIANGLE_QUALITY_H_

#include <algorithm>
#include <limits>
#include <numbers>

#include "geometry/mesh.h"

// How good a triangle is, without trigonometry.  Both measures are free of scale, fall as the
// triangle gets rounder, and are infinite when it has no positive area in double.

namespace posespace {

// The cotangent of the smallest angle: the smaller angle of two is the one of larger sharpness.
inline double Sharpness(const Point& a, const Point& b, const Point& c) {
  const double doubled_area = Cross(a, b, c);
  if (!(doubled_area > 0.0)) return std::numeric_limits<double>::infinity();
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  return (ab + bc + ca - 2.0 * std::min({ab, bc, ca})) / (2.0 * doubled_area);
}

// The largest Sharpness of a mesh, over all poses.
inline double SharpestOf(const CompatibleMesh& mesh) {
  double sharpest = 0.0;
  for (const Points& pose : mesh.poses) {
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      const auto corners = mesh.triangles.row(t);
      sharpest = std::max(
          sharpest, Sharpness(pose.row(corners[0]), pose.row(corners[1]), pose.row(corners[2])));
    }
  }
  return sharpest;
}

// A tenth of a degree.  A triangle sharper than this is a sliver: valid, but of no use to a blend
// where another can be had.
inline constexpr double kSliverSharpness = 573.0;

// Sum of squared sides over area, 1 for an equilateral triangle (inverse mean ratio).  As a
// function of one corner it is convex where the triangle is positive.
inline double Distortion(const Point& a, const Point& b, const Point& c) {
  const double doubled_area = Cross(a, b, c);
  if (!(doubled_area > 0.0)) return std::numeric_limits<double>::infinity();
  const double sides = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return sides / (2.0 * std::numbers::sqrt3 * doubled_area);
}

}  // namespace posespace

#endif  // POSESPACE_MAPPING_TRIANGLE_QUALITY_H_
