// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_GHOST_LOSS_H_
#define POSESPACE_DRAWING_GHOST_LOSS_H_

#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace posespace {

// How much of the drawings' own detail an even mix of them loses: where an eye lies on a cheek,
// both are pale ghosts.  With g_i the gradients of picture i over all channels and g their mean,
//
//   all     = 1 - sum |g|^2 / mean_i sum |g_i|^2       sums over the pixels
//   each[i] = 1 - sum g_i . g / sum |g_i|^2            what is lost of picture i's own detail
//
// so that `all` is the mean of `each`, weighted with the pictures' detail.  0 when the pictures
// are equal, or have no detail; 1 - 1/N when no two have detail at the same place.  (The mean of
// |g| itself would not do: two edges side by side, each half as strong, have as much of it as one.)
struct GhostLoss {
  double all = 0.0;
  std::vector<double> each;
};

// Over the pixels where `mask` is not 0.
// Requires  pictures and mask of one size.
GhostLoss MeasureGhosts(std::span<const cv::Mat3f> pictures, const cv::Mat1b& mask);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_GHOST_LOSS_H_
