// SPDX-License-Identifier: Apache-2.0
#include "drawing/paint_filling.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace posespace {

cv::Mat3f FillBeyondPaint(const cv::Mat4f& picture) {
  // Halves of halves: each coarser level covers twice as far from the paint.
  std::vector<cv::Mat4f> levels{picture};
  while (std::max(levels.back().rows, levels.back().cols) > 2) {
    cv::Mat4f coarser;
    cv::pyrDown(levels.back(), coarser);
    levels.push_back(coarser);
  }
  cv::Mat4f filled = levels.back();
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    cv::Mat4f below = filled;
    if (level != levels.rbegin()) cv::pyrUp(filled, below, level->size());
    filled = cv::Mat4f(level->size());
    for (int y = 0; y < filled.rows; ++y) {
      for (int x = 0; x < filled.cols; ++x) {
        const cv::Vec4f& here = (*level)(y, x);
        const cv::Vec4f& under = below(y, x);
        const cv::Vec4f sum = here + (1.0f - here[3]) * under;
        filled(y, x) = sum[3] > 0.0f ? sum / sum[3] : cv::Vec4f::all(0.0f);
      }
    }
  }
  cv::Mat3f colours;
  cv::cvtColor(filled, colours, cv::COLOR_RGBA2RGB);
  return colours;
}

}  // namespace posespace
