// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_ANCHOR_H_
#define POSESPACE_INTERPOLATION_ANCHOR_H_

#include <span>

#include "geometry/mesh.h"

namespace posespace {

// A place in a mesh, the same in every pose and blend: corners a, b, c of a triangle weigh
// 1 - b - c, b and c.
struct MeshPoint {
  int triangle = 0;
  double b = 0.0, c = 0.0;

  bool operator==(const MeshPoint&) const = default;

  // `place_of(v)` is where vertex v lies.
  template <typename PlaceOf>
  Point In(const Triangles& triangles, const PlaceOf& place_of) const {
    const auto corner = triangles.row(triangle);
    return (1.0 - b - c) * Point(place_of(corner[0])) + b * Point(place_of(corner[1])) +
           c * Point(place_of(corner[2]));
  }
};

// Where a blend that holds an anchor puts it: sum w_i times its place in pose i.
inline Point AnchorPlace(const MeshPoint& anchor, const Triangles& triangles,
                         std::span<const Points> poses, std::span<const double> weights) {
  Point sum = Point::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum += weights[i] *
           anchor.In(triangles, [&](int v) -> Point { return poses[i].row(v).transpose(); });
  }
  return sum;
}

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_ANCHOR_H_
