// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_LOCAL_DIFFERENCE_H_
#define POSESPACE_DRAWING_LOCAL_DIFFERENCE_H_

#include <opencv2/core.hpp>
#include <span>
#include <vector>

namespace posespace {

// For each picture, how much it differs from the others around each pixel: the squared difference
// of colours (RGB in [0, 1]), at most that of colours which have nothing in common, its mean over
// the others, gathered over `reach` pixels (standard deviation).  Pixels where `mask` is 0 count as
// alike.
//
// Requires  two pictures or more, of the size of the mask.
std::vector<cv::Mat1f> LocalDifferences(std::span<const cv::Mat3f> pictures, const cv::Mat1b& mask,
                                        double reach);

// How much of its moves a picture keeps at each place, 0 .. 1: all where it clearly differs less
// for them, or differed from nothing; none where it differs as much as before; smoothly between.
cv::Mat1f ShareToKeep(const cv::Mat1f& before, const cv::Mat1f& after);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_LOCAL_DIFFERENCE_H_
