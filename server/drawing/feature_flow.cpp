// SPDX-License-Identifier: Apache-2.0
#include "drawing/feature_flow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

namespace posespace {
namespace {

// How far colours of the same place may differ, RGB in [0, 1] (standard deviation).
constexpr float kLikeness = 0.2f;

cv::Mat1b Brightness(const cv::Mat3f& picture) {
  cv::Mat1f grey;
  cv::cvtColor(picture, grey, cv::COLOR_RGB2GRAY);
  cv::Mat1b bytes;
  grey.convertTo(bytes, CV_8U, 255.0);
  return bytes;
}

// Sum over channels of the squared gradient.
cv::Mat1f GradientEnergy(const cv::Mat3f& picture) {
  cv::Mat3f along_x, along_y;
  cv::Sobel(picture, along_x, CV_32F, 1, 0, 3, 1.0 / 8.0);
  cv::Sobel(picture, along_y, CV_32F, 0, 1, 3, 1.0 / 8.0);
  cv::Mat1f energy(picture.size());
  for (int y = 0; y < energy.rows; ++y) {
    for (int x = 0; x < energy.cols; ++x) {
      energy(y, x) = along_x(y, x).dot(along_x(y, x)) + along_y(y, x).dot(along_y(y, x));
    }
  }
  return energy;
}

}  // namespace

cv::Mat3f FeatureFlow(const cv::Mat3f& from, const cv::Mat3f& to, double reach) {
  const auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  cv::Mat2f flow;
  search->calc(Brightness(from), Brightness(to), flow);

  cv::Mat2f places(flow.size());
  for (int y = 0; y < flow.rows; ++y) {
    for (int x = 0; x < flow.cols; ++x) places(y, x) = flow(y, x) + cv::Vec2f(x, y);
  }
  cv::Mat3f found;
  cv::remap(to, found, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const cv::Mat1f detail_here = GradientEnergy(from), detail_there = GradientEnergy(found);
  cv::Mat3f gathered(flow.size());
  for (int y = 0; y < flow.rows; ++y) {
    for (int x = 0; x < flow.cols; ++x) {
      const cv::Vec3f difference = found(y, x) - from(y, x);
      const float agreement =
          std::exp(-difference.dot(difference) / (2.0f * kLikeness * kLikeness));
      const float trust = agreement * std::min(detail_here(y, x), detail_there(y, x));
      gathered(y, x) = {trust * flow(y, x)[0], trust * flow(y, x)[1], trust};
    }
  }
  cv::GaussianBlur(gathered, gathered, {}, reach, 0, cv::BORDER_REPLICATE);
  for (cv::Vec3f& each : gathered) {
    if (each[2] > 0.0f) each = {each[0] / each[2], each[1] / each[2], each[2]};
  }
  return gathered;
}

}  // namespace posespace
