// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_OUTLINE_COLOURS_H_
#define POSESPACE_DRAWING_OUTLINE_COLOURS_H_

#include "drawing/image.h"
#include "drawing/working_picture.h"
#include "geometry/mesh.h"

namespace posespace {

// RGB in [0, 1] (sRGB) at each place, K x 3: the mean of the painted pixels around it, weighted by
// their alpha and by a Gaussian of 1/64 of the drawing's longer side.  Places are in working
// pixels.  Far from all paint, as on a bridge, the colour tends to the drawing's mean.
Eigen::MatrixXd ColoursAt(const Points& places, const Image& image, int threshold,
                          const WorkingFrame& frame);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_OUTLINE_COLOURS_H_
