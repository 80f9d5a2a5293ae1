// SPDX-License-Identifier: Apache-2.0
#include "drawing/common_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace posespace {
namespace {

constexpr double kMargin = 2.0;  // pixels around the common pose
constexpr int kLeastSide = 64;   // pixels: image flow needs room for its patches

}  // namespace

CommonPose::CommonPose(const Triangles& triangles, const Points& vertices, int size)
    : triangles_(triangles) {
  const Point low = vertices.colwise().minCoeff(), high = vertices.colwise().maxCoeff();
  const Point extent = high - low;
  const double longest = extent.maxCoeff();
  const double scale = longest > 0.0 ? size / longest : 1.0;
  raster_ = ((vertices.rowwise() - low.transpose()) * scale).array() + kMargin - 0.5;
  const auto pixels = [&](double length) {
    return std::max(kLeastSide, static_cast<int>(std::ceil(length * scale + 2.0 * kMargin)));
  };
  ids_ = cv::Mat1i(pixels(extent.y()), pixels(extent.x()), -1);

  for (int t = 0; t < triangles_.rows(); ++t) {
    const auto corner = [&](int k) -> Point { return raster_.row(triangles_(t, k)).transpose(); };
    if (Cross(corner(0), corner(1), corner(2)) == 0.0) continue;
    const auto [low_y, high_y] = std::minmax({corner(0).y(), corner(1).y(), corner(2).y()});
    const Eigen::Vector3d origin = Barycentric(t, {0.0, 0.0});
    const Eigen::Vector3d along = Barycentric(t, {1.0, 0.0}) - origin;
    if (!along.allFinite()) continue;  // an area too small to divide by
    for (int y = static_cast<int>(std::ceil(low_y)); y <= high_y; ++y) {
      // The pixels of the row whose three weights are not negative.
      const Eigen::Vector3d weights = Barycentric(t, {0.0, static_cast<double>(y)});
      double first = 0.0, last = ids_.cols - 1.0;
      for (int k = 0; k < 3; ++k) {
        if (along[k] > 0.0) first = std::max(first, -weights[k] / along[k]);
        if (along[k] < 0.0) last = std::min(last, -weights[k] / along[k]);
        if (along[k] == 0.0 && weights[k] < 0.0) last = -1.0;
      }
      if (!(first <= last)) continue;
      for (int x = static_cast<int>(std::ceil(first)); x <= last; ++x) ids_(y, x) = t;
    }
  }
}

Point CommonPose::ToRaster(int vertex) const { return raster_.row(vertex).transpose(); }

Eigen::Vector3d CommonPose::Barycentric(int triangle, const Point& at) const {
  const auto corners = triangles_.row(triangle);
  const Point a = raster_.row(corners[0]), b = raster_.row(corners[1]), c = raster_.row(corners[2]);
  const double area = Cross(a, b, c);
  const double of_a = Cross(at, b, c) / area, of_b = Cross(a, at, c) / area;
  return {of_a, of_b, 1.0 - of_a - of_b};
}

cv::Mat4f CommonPose::Warp(const Points& pose, const ReducedTexture& texture) const {
  // Per triangle, the affine map from raster to texel centres: offset + x * right + y * down.
  struct Map {
    Point offset, right, down;
  };
  std::vector<Map> maps(triangles_.rows());
  for (int t = 0; t < triangles_.rows(); ++t) {
    const auto corners = triangles_.row(t);
    const auto texel = [&](double x, double y) -> Point {
      const Eigen::Vector3d weights = Barycentric(t, {x, y});
      const Point place = weights[0] * pose.row(corners[0]) + weights[1] * pose.row(corners[1]) +
                          weights[2] * pose.row(corners[2]);
      return (place - texture.origin) * texture.scale - Point(0.5, 0.5);
    };
    const Point offset = texel(0.0, 0.0);
    maps[t] = {offset, texel(1.0, 0.0) - offset, texel(0.0, 1.0) - offset};
  }
  const cv::Mat4f source(texture.height, texture.width,
                         reinterpret_cast<cv::Vec4f*>(const_cast<float*>(texture.rgba.data())));
  if (source.empty()) return cv::Mat4f(ids_.size(), cv::Vec4f::all(0.0f));
  constexpr float kNowhere = -10.0f;
  cv::Mat2f texels(ids_.size(), cv::Vec2f(kNowhere, kNowhere));
  for (int y = 0; y < ids_.rows; ++y) {
    for (int x = 0; x < ids_.cols; ++x) {
      const int t = ids_(y, x);
      if (t < 0) continue;
      const Point at = maps[t].offset + x * maps[t].right + y * maps[t].down;
      texels(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  }
  cv::Mat4f picture;
  cv::remap(source, picture, texels, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT,
            cv::Scalar::all(0.0));
  return picture;
}

std::optional<Point> CommonPose::Interpolate(const Point& at, const Points& values) const {
  const double x = std::round(at.x()), y = std::round(at.y());
  if (!(x >= 0.0 && y >= 0.0 && x < ids_.cols && y < ids_.rows)) return std::nullopt;
  const int t = ids_(static_cast<int>(y), static_cast<int>(x));
  if (t < 0) return std::nullopt;
  const Eigen::Vector3d weights = Barycentric(t, at);
  return (weights[0] * values.row(triangles_(t, 0)) + weights[1] * values.row(triangles_(t, 1)) +
          weights[2] * values.row(triangles_(t, 2)))
      .transpose();
}

}  // namespace posespace
