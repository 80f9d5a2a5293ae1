// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_FEATURE_FLOW_H_
#define POSESPACE_DRAWING_FEATURE_FLOW_H_

#include <opencv2/core.hpp>

namespace posespace {

// For each pixel of `from`: how far the same feature lies away in `to`, pixels (x, y), and how much
// that is to be trusted: the detail around it (squared gradient), as far as both pictures agree
// about it.  Gathered over `reach` pixels (standard deviation).
//
// Requires  filled pictures of one size.
// Follows   Kroeger, Timofte, Dai, Van Gool 2016 (dense inverse search), by OpenCV.
cv::Mat3f FeatureFlow(const cv::Mat3f& from, const cv::Mat3f& to, double reach);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_FEATURE_FLOW_H_
