// SPDX-License-Identifier: Apache-2.0
#include "drawing/local_difference.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace posespace {

std::vector<cv::Mat1f> LocalDifferences(std::span<const cv::Mat3f> pictures, const cv::Mat1b& mask,
                                        double reach) {
  constexpr float kNothingInCommon = 0.1f;
  std::vector<cv::Mat1f> differences(pictures.size());
  for (cv::Mat1f& each : differences) each = cv::Mat1f(mask.size(), 0.0f);
  const float share = 1.0f / static_cast<float>(pictures.size() - 1);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (int y = 0; y < mask.rows; ++y) {
        for (int x = 0; x < mask.cols; ++x) {
          if (mask(y, x) == 0) continue;
          const cv::Vec3f between = pictures[i](y, x) - pictures[j](y, x);
          const float difference = share * std::min(between.dot(between), kNothingInCommon);
          differences[i](y, x) += difference;
          differences[j](y, x) += difference;
        }
      }
    }
  }
  for (cv::Mat1f& each : differences) {
    cv::GaussianBlur(each, each, {}, reach, 0, cv::BORDER_REPLICATE);
  }
  return differences;
}

cv::Mat1f ShareToKeep(const cv::Mat1f& before, const cv::Mat1f& after) {
  constexpr double kClearGain = 0.1;   // the part of a difference that has gone
  constexpr double kUnnoticed = 5e-4;  // squared difference of colours that is none
  cv::Mat1f share(before.size());
  for (int y = 0; y < share.rows; ++y) {
    for (int x = 0; x < share.cols; ++x) {
      const double gain = 1.0 - after(y, x) / (before(y, x) + kUnnoticed);
      const double t = std::clamp(gain / kClearGain, 0.0, 1.0);
      share(y, x) = static_cast<float>(t * t * (3.0 - 2.0 * t));
    }
  }
  return share;
}

}  // namespace posespace
