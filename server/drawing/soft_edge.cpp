// SPDX-License-Identifier: Apache-2.0
#include "drawing/soft_edge.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace posespace {
namespace {

constexpr int kEdgeWidth = 3;     // pixels, on either side of the border of what is painted
constexpr double kOpaque = 0.97;  // shares from here on are the drawing's own

// The neighbours of a pixel, `visit`ed where they lie in the picture.
template <typename Visit>
void ForNeighbours(const cv::Mat1b& map, cv::Point at, const Visit& visit) {
  for (int y = std::max(0, at.y - 1); y <= std::min(map.rows - 1, at.y + 1); ++y) {
    for (int x = std::max(0, at.x - 1); x <= std::min(map.cols - 1, at.x + 1); ++x) {
      if (x != at.x || y != at.y) visit(cv::Point(x, y));
    }
  }
}

// The pixel of the drawing that an edge pixel is mixed of.
cv::Point Climb(const cv::Mat1b& distance, cv::Point at) {
  for (int step = 0; step < kEdgeWidth; ++step) {
    cv::Point highest = at;
    ForNeighbours(distance, at, [&](cv::Point p) {
      if (distance(p) > distance(highest)) highest = p;
    });
    if (highest == at) break;
    at = highest;
  }
  return at;
}

double ShareOfDrawing(const Background& background, cv::Point at) {
  const cv::Point top = Climb(background.distance, at);
  if (background.painted(top) == 0) return 0.0;
  const double whole = background.distance(top) - background.noise;
  const double here = background.distance(at) - background.noise;
  return whole > 0.0 ? std::clamp(here / whole, 0.0, 1.0) : 1.0;
}

// Takes the background out of a pixel of which `share` is the drawing's.
void Unmix(const Rgb& background, double share, std::uint8_t* pixel) {
  pixel[3] = static_cast<std::uint8_t>(std::lround(255.0 * share));
  if (pixel[3] == 0) return;
  for (int c = 0; c < 3; ++c) {
    const double colour = background[c] + (pixel[c] - background[c]) / share;
    pixel[c] = static_cast<std::uint8_t>(std::lround(std::clamp(colour, 0.0, 255.0)));
  }
}

}  // namespace

void FadeBackground(const Background& background, Image* image) {
  const cv::Mat1b& painted = background.painted;
  const auto pixel = [&](cv::Point p) { return image->at(p.x, p.y); };

  // Outside: what lies beyond the edge is gone.
  cv::Mat1b near_drawing;
  cv::dilate(painted, near_drawing, cv::Mat1b::ones(2 * kEdgeWidth + 1, 2 * kEdgeWidth + 1));
  for (int y = 0; y < painted.rows; ++y) {
    for (int x = 0; x < painted.cols; ++x) {
      const cv::Point at(x, y);
      if (painted(at) != 0) continue;
      Unmix(background.colour, near_drawing(at) == 0 ? 0.0 : ShareOfDrawing(background, at),
            pixel(at));
    }
  }

  // Inside: from the border inwards, as long as pixels are mixed.
  std::vector<cv::Point> layer, next;
  cv::Mat1b seen = painted == 0;
  cv::Mat1b border;
  cv::dilate(seen, border, cv::Mat1b::ones(3, 3));
  for (int y = 0; y < painted.rows; ++y) {
    for (int x = 0; x < painted.cols; ++x) {
      if (border(y, x) != 0 && seen(y, x) == 0) layer.emplace_back(x, y);
    }
  }
  for (const cv::Point at : layer) seen(at) = 255;
  for (int depth = 0; depth < kEdgeWidth; ++depth) {
    next.clear();
    for (const cv::Point at : layer) {
      const double share = ShareOfDrawing(background, at);
      if (share >= kOpaque) continue;
      Unmix(background.colour, share, pixel(at));
      ForNeighbours(painted, at, [&](cv::Point p) {
        if (seen(p) != 0) return;
        seen(p) = 255;
        next.push_back(p);
      });
    }
    layer.swap(next);
  }
}

}  // namespace posespace
