// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_PAINT_FILLING_H_
#define POSESPACE_DRAWING_PAINT_FILLING_H_

#include <opencv2/core.hpp>

namespace posespace {

// The colours of a premultiplied picture, continued smoothly to where nothing is painted, so that
// the edge of the painting is no edge of the result.  All zero for an empty picture.
cv::Mat3f FillBeyondPaint(const cv::Mat4f& picture);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_PAINT_FILLING_H_
