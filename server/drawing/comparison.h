// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_COMPARISON_H_
#define POSESPACE_DRAWING_COMPARISON_H_

#include <opencv2/core.hpp>
#include <span>

#include "drawing/alignment.h"
#include "drawing/common_pose.h"
#include "drawing/interior_moves.h"
#include "geometry/mesh.h"

namespace posespace {

// The vertices of one drawing on their way.
struct Moving {
  InteriorMoves moves;
  Points field;  // V x 2, raster pixels: vertex v lies where the drawing was at common_v + field_v
};

// What all drawings of a mesh are compared in, and what moves them by what was seen there.
// Refers to mesh and textures.  Immutable.
class Comparison {
 public:
  Comparison(const CompatibleMesh& mesh, const Points& common,
             std::span<const ReducedTexture> textures);

  // Longer side of the raster, pixels.
  int size() const { return size_; }

  // Drawing i where it was given.
  Moving Unmoved(std::size_t i) const;

  // Drawing i with its vertices at `pose`, on the raster: premultiplied RGBA.
  cv::Mat4f Warp(std::size_t i, const Points& pose) const;

  // The field that brings the features of a picture, warped by `moving`, to where `from` has them.
  Points FieldTowards(const cv::Mat3f& from, const cv::Mat3f& picture, const Moving& moving) const;

  // Moves the vertices of drawing i towards the field `goal` as far as the mesh allows.
  void Move(std::size_t i, const Points& goal, Moving* moving) const;

  // The field with its values multiplied by those of a picture where the vertices lie.
  Points Scaled(const Points& field, const cv::Mat1f& share) const;

 private:
  cv::Point PixelOf(int vertex) const;

  const CompatibleMesh& mesh_;
  std::span<const ReducedTexture> textures_;
  Edges edges_;
  int size_;
  CommonPose raster_;
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_COMPARISON_H_
