// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_KIN_H_
#define POSESPACE_DRAWING_KIN_H_

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

// Groups of pictures that show the same, however it has moved: fronts of a figure, and its backs.
// Each group begins with the one that differs least from all that were left; the others of it look
// like it when image flow carries their features to where it has them.  What looks like no other
// is a group of its own.  The order of the pictures changes nothing but labels.
//
// Requires  filled pictures of one size; `mask` is not 0 where they count.
// Fails     kCancelled.
// Cost      for each group, one flow at a reduced size to each picture that is left.
Result<std::vector<std::vector<int>>> KinOf(std::span<const cv::Mat3f> pictures,
                                            const cv::Mat1b& mask,
                                            const Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_KIN_H_
