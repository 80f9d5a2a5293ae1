// SPDX-License-Identifier: Apache-2.0
#include "drawing/working_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace posespace {
namespace {

// Beyond this enlargement single pixels show as steps, which are blurred away.
constexpr double kPixelArtScale = 2.0;
constexpr double kPixelArtBlur = 0.35;  // standard deviation / pixel of the picture

std::vector<int> CellOfEachPixel(int pixels, int cells) {
  std::vector<int> cell(pixels);
  const double scale = static_cast<double>(cells) / pixels;
  for (int i = 0; i < pixels; ++i)
    cell[i] = std::min(cells - 1, static_cast<int>((i + 0.5) * scale));
  return cell;
}

}  // namespace

PaintedBox FindPainted(const Image& image, int threshold) {
  PaintedBox box;
  int left = std::numeric_limits<int>::max(), right = -1, top = -1, bottom = -1;
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* alpha = image.at(0, y) + 3;
    for (int x = 0; x < image.width; ++x) {
      if (alpha[4 * static_cast<std::size_t>(x)] < threshold) continue;
      ++box.painted;
      left = std::min(left, x);
      right = std::max(right, x);
      if (top < 0) top = y;
      bottom = y;
    }
  }
  if (box.painted == 0) return box;
  box.left = left;
  box.top = top;
  box.width = right - left + 1;
  box.height = bottom - top + 1;
  return box;
}

WorkingFrame::WorkingFrame(const PaintedBox& box, int working_size) : box_(box) {
  scale_ = static_cast<double>(working_size) / std::max(box.width, box.height);
  width_ = std::max(1, static_cast<int>(std::lround(box.width * scale_)));
  height_ = std::max(1, static_cast<int>(std::lround(box.height * scale_)));
  scale_x_ = static_cast<double>(width_) / box.width;
  scale_y_ = static_cast<double>(height_) / box.height;
  columns_ = CellOfEachPixel(box.width, width_);
  rows_ = CellOfEachPixel(box.height, height_);
  for (int& column : columns_) column += kMargin;
  for (int& row : rows_) row += kMargin;
}

cv::Mat1b WorkingFrame::Paint(const Image& image, int threshold) const {
  cv::Mat1b painted = cv::Mat1b::zeros(size());
  if (scale_ > 1.0) {
    cv::Mat1f alpha = cv::Mat1f::zeros(box_.height, box_.width);
    for (int y = 0; y < box_.height; ++y) {
      for (int x = 0; x < box_.width; ++x) {
        const int value = image.at(box_.left + x, box_.top + y)[3];
        if (value < threshold) continue;
        alpha(y, x) = 0.5f + 0.5f * static_cast<float>(value - threshold + 1) /
                                 static_cast<float>(256 - threshold);
      }
    }
    cv::Mat1f enlarged;
    cv::resize(alpha, enlarged, {width_, height_}, 0, 0, cv::INTER_CUBIC);
    if (scale_ > kPixelArtScale) {
      cv::GaussianBlur(enlarged, enlarged, {}, kPixelArtBlur * scale_, 0, cv::BORDER_REPLICATE);
    }
    const cv::Mat inner(enlarged >= 0.5f);
    inner.copyTo(painted({kMargin, kMargin, width_, height_}));
  }
  for (int y = box_.top; y < box_.top + box_.height; ++y) {
    std::uint8_t* cells = painted[row(y)];
    const std::uint8_t* alpha = image.at(box_.left, y) + 3;
    for (int x = 0; x < box_.width; ++x) {
      if (alpha[4 * static_cast<std::size_t>(x)] >= threshold) cells[columns_[x]] = 255;
    }
  }
  return painted;
}

}  // namespace posespace
