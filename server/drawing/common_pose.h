// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_COMMON_POSE_H_
#define POSESPACE_DRAWING_COMMON_POSE_H_

#include <opencv2/core.hpp>
#include <optional>

#include "drawing/alignment.h"
#include "geometry/mesh.h"

namespace posespace {

// Where drawings are compared: a raster of one drawing of the mesh, the common pose, onto which
// every other drawing can be warped.  Immutable.
class CommonPose {
 public:
  // `vertices` (V x 2) are the common pose; the longer side of its box takes `size` pixels of the
  // raster.  Where triangles fold over each other, later ones lie on top.
  CommonPose(const Triangles& triangles, const Points& vertices, int size);

  cv::Size size() const { return ids_.size(); }

  // Place of a vertex of the common pose on the raster: pixel (i, j) has its centre at (i, j).
  Point ToRaster(int vertex) const;

  // The drawing whose mesh is `pose`, warped to the common pose: premultiplied RGBA, transparent
  // outside the mesh.
  cv::Mat4f Warp(const Points& pose, const ReducedTexture& texture) const;

  // The value at the place `at` of the raster of what is linear in each triangle, given at the
  // vertices (V x 2): the place in a drawing whose mesh these are.  Nothing outside the mesh.
  std::optional<Point> Interpolate(const Point& at, const Points& values) const;

 private:
  Eigen::Vector3d Barycentric(int triangle, const Point& at) const;

  Triangles triangles_;
  Points raster_;  // V x 2: the common pose on the raster
  cv::Mat1i ids_;  // triangle of each pixel, -1 outside
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_COMMON_POSE_H_
