// SPDX-License-Identifier: Apache-2.0
#include "drawing/edge_distance.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace posespace {
namespace {

constexpr std::uint8_t kPainted = 128;  // alpha
constexpr float kFarthest = 511.0f;     // pixels
constexpr double kSmoothing = 0.7;      // pixels, deviation: takes the steps out of slanted edges

// Distance of the centre of each pixel that is not 0 from the border of those that are.
cv::Mat1f DistanceFromZero(const cv::Mat1b& mask) {
  cv::Mat1f distance;
  cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE, CV_32F);
  distance = cv::min(distance, kFarthest);  // all of it where no pixel is 0
  for (float& each : distance) each = std::max(each - 0.5f, 0.0f);
  return distance;
}

}  // namespace

std::vector<std::int16_t> EdgeDistance(const Image& image) {
  if (image.width <= 0 || image.height <= 0) return {};
  cv::Mat1b inside = cv::Mat1b::zeros(image.height + 2, image.width + 2);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.at(x, y)[3] >= kPainted) inside(y + 1, x + 1) = 255;
    }
  }
  const cv::Mat1b outside = 255 - inside;
  cv::Mat1f distance = DistanceFromZero(inside) - DistanceFromZero(outside);
  cv::GaussianBlur(distance, distance, {}, kSmoothing, 0, cv::BORDER_REPLICATE);
  std::vector<std::int16_t> units(static_cast<std::size_t>(image.width) * image.height);
  cv::Mat1s counted(image.height, image.width, units.data());
  distance({1, 1, image.width, image.height}).convertTo(counted, CV_16S, kEdgeDistanceUnits);
  return units;
}

}  // namespace posespace
