// SPDX-License-Identifier: Apache-2.0
#include "drawing/colours_beyond.h"

#include <algorithm>
#include <opencv2/core.hpp>

#include "drawing/paint_filling.h"

namespace posespace {

std::vector<float> ColoursBeyond(int width, int height, std::span<const float> premultiplied) {
  if (premultiplied.empty()) return {};
  cv::Mat4f picture(height, width);
  std::copy(premultiplied.begin(), premultiplied.end(), picture.ptr<float>());
  std::vector<float> opaque;
  opaque.reserve(premultiplied.size());
  for (const cv::Vec3f& colour : FillBeyondPaint(picture)) {
    opaque.insert(opaque.end(), {colour[0], colour[1], colour[2], 1.0f});
  }
  return opaque;
}

}  // namespace posespace
