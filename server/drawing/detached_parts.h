// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_DETACHED_PARTS_H_
#define POSESPACE_DRAWING_DETACHED_PARTS_H_

#include <opencv2/core.hpp>

namespace posespace {

// Joins the detached parts of a mask by bridges, painted into it.
//
// Parts (8-connected) of at least `smallest_share` of the painted pixels, and in any case the
// largest, become one by bridges `width` pixels wide: the shortest ones that connect them all, each
// between the closest points of its two parts.  Smaller parts are left as they are.
struct JoinedParts {
  int bridges = 0;
  cv::Point body;  // a painted pixel of the largest part
};
JoinedParts JoinParts(cv::Mat1b& mask, double smallest_share, int width);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_DETACHED_PARTS_H_
