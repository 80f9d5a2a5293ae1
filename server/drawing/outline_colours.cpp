// SPDX-License-Identifier: Apache-2.0
#include "drawing/outline_colours.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace posespace {
namespace {

// The blur is wide, so a coarse grid carries it: 1/64 of the drawing is 2 cells.
constexpr int kCellsAlongDrawing = 128;
constexpr double kBlurCells = 2.0;

// Weight of the drawing's mean colour / weight of paint all around: felt only far from any paint.
constexpr double kMeanWeight = 1e-4;

}  // namespace

Eigen::MatrixXd ColoursAt(const Points& places, const Image& image, int threshold,
                          const WorkingFrame& frame) {
  const cv::Size size = frame.size();
  const PaintedBox& box = frame.box();
  const double cell = frame.scale() * std::max(box.width, box.height) / kCellsAlongDrawing;
  const auto cells = [&](int pixels) { return static_cast<int>(pixels / cell) + 1; };
  const auto index = [&](int pixel) { return static_cast<int>((pixel + 0.5) / cell); };

  // Premultiplied colour and alpha gathered in cells, then blurred: a normalised convolution.
  cv::Mat4f gathered = cv::Mat4f::zeros(cells(size.height), cells(size.width));
  for (int y = box.top; y < box.top + box.height; ++y) {
    cv::Vec4f* row = gathered[index(frame.row(y))];
    for (int x = box.left; x < box.left + box.width; ++x) {
      const std::uint8_t* pixel = image.at(x, y);
      if (pixel[3] < threshold) continue;
      const float alpha = static_cast<float>(pixel[3]) / 255.0f;
      row[index(frame.column(x))] +=
          cv::Vec4f(alpha * static_cast<float>(pixel[0]) / 255.0f,
                    alpha * static_cast<float>(pixel[1]) / 255.0f,
                    alpha * static_cast<float>(pixel[2]) / 255.0f, alpha);
    }
  }
  const cv::Scalar sum = cv::sum(gathered);
  const double pixels_per_cell = cell * cell / (frame.scale() * frame.scale());
  const cv::Vec4f far_colour = cv::Vec4d(sum) * (kMeanWeight * pixels_per_cell / sum[3]);
  cv::GaussianBlur(gathered, gathered, {}, kBlurCells, 0, cv::BORDER_CONSTANT);

  Eigen::MatrixXd colours(places.rows(), 3);
  for (int k = 0; k < places.rows(); ++k) {
    // Bilinear between cell centres.
    const double u = std::clamp(places(k, 0) / cell - 0.5, 0.0, gathered.cols - 1.0);
    const double v = std::clamp(places(k, 1) / cell - 0.5, 0.0, gathered.rows - 1.0);
    const int x = std::min(static_cast<int>(u), std::max(0, gathered.cols - 2));
    const int y = std::min(static_cast<int>(v), std::max(0, gathered.rows - 2));
    const int right = std::min(x + 1, gathered.cols - 1),
              below = std::min(y + 1, gathered.rows - 1);
    const float s = static_cast<float>(u - x), t = static_cast<float>(v - y);
    const cv::Vec4f here = (1 - t) * ((1 - s) * gathered(y, x) + s * gathered(y, right)) +
                           t * ((1 - s) * gathered(below, x) + s * gathered(below, right)) +
                           far_colour;
    for (int c = 0; c < 3; ++c) {
      colours(k, c) = std::clamp(static_cast<double>(here[c] / here[3]), 0.0, 1.0);
    }
  }
  return colours;
}

}  // namespace posespace
