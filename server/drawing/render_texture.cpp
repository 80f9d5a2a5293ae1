// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "drawing/colour_space.h"
#include "drawing/colours_beyond.h"
#include "drawing/edge_distance.h"
#include "drawing/render.h"

namespace posespace {
namespace {

constexpr int kFillLevel = 2;  // colours beyond the painting need no more than its quarter

}  // namespace

RenderTexture::RenderTexture(const Texture& texture)
    : origin_(texture.origin), edge_distance_(EdgeDistance(texture.image)) {
  const Image& image = texture.image;
  Level finest{image.width, image.height, texture.scale, {}};
  finest.texels.resize(image.rgba.size());
  for (std::size_t k = 0; k + 3 < image.rgba.size(); k += 4) {
    const float alpha = static_cast<float>(image.rgba[k + 3]) / 255.0f;
    for (int c = 0; c < 3; ++c) finest.texels[k + c] = alpha * LinearFromSrgb(image.rgba[k + c]);
    finest.texels[k + 3] = alpha;
  }
  levels_.push_back(std::move(finest));

  // Each next level averages 2 x 2 texels; beyond the picture all is transparent.
  while (std::max(levels_.back().width, levels_.back().height) > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, 0.5 * fine.scale, {}};
    coarse.texels.assign(4 * static_cast<std::size_t>(coarse.width) * coarse.height, 0.0f);
    for (int y = 0; y < fine.height; ++y) {
      const float* from = fine.texels.data() + 4 * static_cast<std::size_t>(y) * fine.width;
      float* to = coarse.texels.data() + 4 * static_cast<std::size_t>(y / 2) * coarse.width;
      for (int x = 0; x < fine.width; ++x) {
        for (int c = 0; c < 4; ++c) to[4 * (x / 2) + c] += 0.25f * from[4 * x + c];
      }
    }
    levels_.push_back(std::move(coarse));
  }
  fill_level_ = std::min(kFillLevel, static_cast<int>(levels_.size()) - 1);
  const Level& rough = levels_[fill_level_];
  fill_ = ColoursBeyond(rough.width, rough.height, rough.texels);
}

Eigen::Array4f RenderTexture::At(const Point& place, int level) const {
  const Level& from = levels_[level];
  const double u = (place.x() - origin_.x()) * from.scale - 0.5;
  const double v = (place.y() - origin_.y()) * from.scale - 0.5;
  if (!(u > -1.0 && v > -1.0 && u < from.width && v < from.height)) return Eigen::Array4f::Zero();
  const int x = static_cast<int>(u + 1.0) - 1, y = static_cast<int>(v + 1.0) - 1;  // floors
  const float s = static_cast<float>(u - x), t = static_cast<float>(v - y);
  const float* texel = from.texels.data() + 4 * (static_cast<std::ptrdiff_t>(y) * from.width + x);
  const std::ptrdiff_t below = 4 * static_cast<std::ptrdiff_t>(from.width);
  using Texel = Eigen::Map<const Eigen::Array4f>;
  if (x >= 0 && y >= 0 && x + 1 < from.width && y + 1 < from.height) {
    return (1.0f - t) * ((1.0f - s) * Texel(texel) + s * Texel(texel + 4)) +
           t * ((1.0f - s) * Texel(texel + below) + s * Texel(texel + below + 4));
  }
  Eigen::Array4f sum = Eigen::Array4f::Zero();
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      if (x + i < 0 || y + j < 0 || x + i >= from.width || y + j >= from.height) continue;
      sum += (i == 0 ? 1.0f - s : s) * (j == 0 ? 1.0f - t : t) * Texel(texel + j * below + 4 * i);
    }
  }
  return sum;
}

int RenderTexture::LevelFor(double length) const {
  const double texels = length * levels_[0].scale;  // along a pixel
  if (!(texels > 1.0)) return 0;
  const double level = std::round(std::log2(texels));
  return static_cast<int>(std::min<double>(level, static_cast<double>(levels_.size()) - 1));
}

RenderTexture::EdgePlace RenderTexture::EdgePlaceAt(const Point& place) const {
  const Level& finest = levels_[0];
  if (edge_distance_.empty()) return {std::numeric_limits<float>::lowest(), {0.0f, 0.0f}};
  const Point at = (place - origin_) * finest.scale - Point(0.5, 0.5);
  const Point nearest = at.cwiseMax(0.0).cwiseMin(Point(finest.width - 1.0, finest.height - 1.0));
  const int x = std::min(static_cast<int>(nearest.x()), std::max(0, finest.width - 2));
  const int y = std::min(static_cast<int>(nearest.y()), std::max(0, finest.height - 2));
  const int right = finest.width > 1 ? 1 : 0, below = finest.height > 1 ? finest.width : 0;
  const float s = static_cast<float>(nearest.x() - x), t = static_cast<float>(nearest.y() - y);
  const std::int16_t* cell =
      edge_distance_.data() + static_cast<std::ptrdiff_t>(y) * finest.width + x;
  const float above_at = (1.0f - s) * cell[0] + s * cell[right];
  const float below_at = (1.0f - s) * cell[below] + s * cell[below + right];
  const float to_right = (1.0f - t) * static_cast<float>(cell[right] - cell[0]) +
                         t * static_cast<float>(cell[below + right] - cell[below]);
  const float units = (1.0f - t) * above_at + t * below_at;
  const float beyond = static_cast<float>((at - nearest).norm());
  return {(units / kEdgeDistanceUnits - beyond) / static_cast<float>(finest.scale),
          Eigen::Vector2f(to_right, below_at - above_at) / kEdgeDistanceUnits};
}

Eigen::Array4f RenderTexture::ColourBeyond(const Point& place) const {
  if (fill_.empty()) return Eigen::Array4f(0.0f, 0.0f, 0.0f, 1.0f);
  const Level& level = levels_[fill_level_];
  const Point last(level.width - 1.0, level.height - 1.0);
  const Point at = ((place - origin_) * level.scale - Point(0.5, 0.5)).cwiseMax(0.0).cwiseMin(last);
  const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
  const int right = std::min(x + 1, level.width - 1), below = std::min(y + 1, level.height - 1);
  const auto texel = [&](int i, int j) {
    return Eigen::Map<const Eigen::Array4f>(fill_.data() +
                                            4 * (static_cast<std::ptrdiff_t>(j) * level.width + i));
  };
  const float s = static_cast<float>(at.x() - x), t = static_cast<float>(at.y() - y);
  return (1.0f - t) * ((1.0f - s) * texel(x, y) + s * texel(right, y)) +
         t * ((1.0f - s) * texel(x, below) + s * texel(right, below));
}

}  // namespace posespace
