// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_WITH_OPENCV_H_
#define POSESPACE_DRAWING_WITH_OPENCV_H_

#include <opencv2/core.hpp>
#include <string>

#include "geometry/result.h"

namespace posespace {

// What `compute` returns, a Result; what OpenCV throws on the way becomes kInternal.  OpenCV is
// held to the calling thread: pictures are worked on side by side, and its own threads would only
// get in the way of streams.
template <typename Compute>
auto WithOpenCv(const Compute& compute) -> decltype(compute()) {
  static const bool one_thread = (cv::setNumThreads(1), true);
  static_cast<void>(one_thread);
  try {
    return compute();
  } catch (const cv::Exception& exception) {
    return Error{ErrorCode::kInternal, std::string("OpenCV: ") + exception.what(), {}};
  }
}

}  // namespace posespace

#endif  // POSESPACE_DRAWING_WITH_OPENCV_H_
