// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstddef>

#include "posespace/error.h"
#include "posespace/results.h"

namespace posespace {
namespace {

double Cross(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace

MeshPoint Mesh::At(const std::string& shape_id, Point point) const {
  const auto pose = std::find_if(poses.begin(), poses.end(),
                                 [&](const PoseMesh& each) { return each.shape_id == shape_id; });
  if (pose == poses.end()) {
    throw Error(ErrorCode::kNotFound, "the mesh has no drawing '" + shape_id + "'",
                "SHAPE_NOT_FOUND");
  }
  MeshPoint nearest;
  double best = -1.0;  // the least weight of a corner: not negative inside
  for (std::size_t t = 0; t < triangles.size() / 3; ++t) {
    std::array<Point, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(triangles[3 * t + k]);
      corner[k] = {pose->vertices[2 * vertex], pose->vertices[2 * vertex + 1]};
    }
    const double area = Cross(corner[0], corner[1], corner[2]);
    const double b = Cross(corner[2], corner[0], point) / area;
    const double c = Cross(corner[0], corner[1], point) / area;
    const double least = std::min({1.0 - b - c, b, c});
    if (!(least > best)) continue;
    best = least;
    nearest = {static_cast<std::int32_t>(t), std::clamp(b, 0.0, 1.0), std::clamp(c, 0.0, 1.0)};
  }
  constexpr double kRounding = 1e-9;
  if (!(best >= -kRounding)) {
    throw Error(ErrorCode::kInvalidArgument,
                "drawing '" + shape_id + "' has nothing at (" + std::to_string(point.x) + ", " +
                    std::to_string(point.y) + "): the point lies outside its mesh",
                "INVALID_OPTION");
  }
  return nearest;
}

}  // namespace posespace
