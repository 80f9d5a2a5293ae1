// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_WORKING_PICTURE_H_
#define POSESPACE_DRAWING_WORKING_PICTURE_H_

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "drawing/image.h"
#include "geometry/mesh.h"

namespace posespace {

// The painted part of a picture: its box, in whole pixels, and how many there are.
struct PaintedBox {
  int left = 0, top = 0, width = 0, height = 0;
  std::int64_t painted = 0;
};
PaintedBox FindPainted(const Image& image, int threshold);

// The raster on which an outline is traced: the painted box at `working_size` pixels along its
// longer side, with an empty frame around it that leaves room for widening.
class WorkingFrame {
 public:
  WorkingFrame(const PaintedBox& box, int working_size);

  cv::Size size() const { return {width_ + 2 * kMargin, height_ + 2 * kMargin}; }
  double scale() const { return scale_; }  // working pixels per pixel of the picture

  // The working pixel in which the centre of a pixel of the painted box lies.
  int column(int x) const { return columns_[x - box_.left]; }
  int row(int y) const { return rows_[y - box_.top]; }

  Point ToDrawing(const Point& p) const {
    return {(p.x() - kMargin) / scale_x_ + box_.left, (p.y() - kMargin) / scale_y_ + box_.top};
  }

  // Where the painting is: alpha at the working scale at least half, the threshold counted as
  // half and everything below it as nothing; and each working pixel in which the centre of a
  // painted pixel lies, so that hairlines survive shrinking.
  cv::Mat1b Paint(const Image& image, int threshold) const;

  const PaintedBox& box() const { return box_; }

 private:
  static constexpr int kMargin = 8;

  PaintedBox box_;
  double scale_, scale_x_, scale_y_;
  int width_, height_;
  std::vector<int> columns_, rows_;
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_WORKING_PICTURE_H_
