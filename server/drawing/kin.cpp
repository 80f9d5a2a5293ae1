// SPDX-License-Identifier: Apache-2.0
#include "drawing/kin.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "drawing/feature_flow.h"

namespace posespace {
namespace {

constexpr double kSide = 192.0;        // pixels, about: enough to tell a face from a back
constexpr double kReach = 4.0;         // pixels: what flow is gathered over
constexpr double kMostUnlike = 0.025;  // mean squared difference of kin, RGB in [0, 1]

// Mean squared difference of two pictures.
double Difference(const cv::Mat3f& a, const cv::Mat3f& b, const cv::Mat1b& mask) {
  const double pixels = cv::countNonZero(mask);
  const double norm = cv::norm(a, b, cv::NORM_L2, mask);
  return pixels > 0.0 ? norm * norm / pixels : 0.0;
}

// The picture with its features where `from` has them.
cv::Mat3f Carried(const cv::Mat3f& from, const cv::Mat3f& picture) {
  const cv::Mat3f flow = FeatureFlow(from, picture, kReach);
  cv::Mat2f places(flow.size());
  for (int y = 0; y < flow.rows; ++y) {
    for (int x = 0; x < flow.cols; ++x) {
      places(y, x) = cv::Vec2f(flow(y, x)[0], flow(y, x)[1]) + cv::Vec2f(x, y);
    }
  }
  cv::Mat3f carried;
  cv::remap(picture, carried, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return carried;
}

}  // namespace

Result<std::vector<std::vector<int>>> KinOf(std::span<const cv::Mat3f> pictures,
                                            const cv::Mat1b& mask, const Progress* progress) {
  const double reduction = std::min(1.0, kSide / std::max(mask.cols, mask.rows));
  std::vector<cv::Mat3f> small(pictures.size());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    cv::resize(pictures[i], small[i], {}, reduction, reduction, cv::INTER_AREA);
  }
  cv::Mat1b counts;
  cv::resize(mask, counts, {}, reduction, reduction, cv::INTER_NEAREST);

  std::vector<int> left(pictures.size());
  std::iota(left.begin(), left.end(), 0);
  std::vector<std::vector<int>> groups;
  while (!left.empty()) {
    std::vector<double> difference(left.size(), 0.0);
    for (std::size_t a = 0; a < left.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const double between = Difference(small[left[a]], small[left[b]], counts);
        difference[a] += between;
        difference[b] += between;
      }
    }
    const int middle =
        left[std::min_element(difference.begin(), difference.end()) - difference.begin()];
    std::vector<int> group = {middle}, others;
    for (const int i : left) {
      if (i == middle) continue;
      if (IsCancelled(progress)) {
        return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}};
      }
      const bool is_kin =
          Difference(small[middle], Carried(small[middle], small[i]), counts) < kMostUnlike;
      (is_kin ? group : others).push_back(i);
    }
    groups.push_back(std::move(group));
    left = std::move(others);
  }
  return groups;
}

}  // namespace posespace
