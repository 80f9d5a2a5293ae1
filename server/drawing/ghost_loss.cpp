// SPDX-License-Identifier: Apache-2.0
#include "drawing/ghost_loss.h"

namespace posespace {

GhostLoss MeasureGhosts(std::span<const cv::Mat3f> pictures, const cv::Mat1b& mask) {
  GhostLoss loss;
  const std::size_t count = pictures.size();
  loss.each.assign(count, 0.0);
  if (count == 0) return loss;

  cv::Mat3f mean(pictures[0].size(), cv::Vec3f::all(0.0f));
  for (const cv::Mat3f& picture : pictures) mean += picture;
  mean *= 1.0 / static_cast<double>(count);

  // Products of the gradients (forward differences) of two pictures.
  const auto product = [&mask](const cv::Mat3f& a, const cv::Mat3f& b) {
    double sum = 0.0;
    for (int y = 0; y + 1 < a.rows; ++y) {
      for (int x = 0; x + 1 < a.cols; ++x) {
        if (mask(y, x) == 0) continue;
        sum += (a(y, x + 1) - a(y, x)).dot(b(y, x + 1) - b(y, x)) +
               (a(y + 1, x) - a(y, x)).dot(b(y + 1, x) - b(y, x));
      }
    }
    return sum;
  };
  double detail = 0.0, lost = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double own = product(pictures[i], pictures[i]);
    const double gone = own - product(pictures[i], mean);
    if (own > 0.0) loss.each[i] = gone / own;
    detail += own;
    lost += gone;
  }
  if (detail > 0.0) loss.all = lost / detail;
  return loss;
}

}  // namespace posespace
