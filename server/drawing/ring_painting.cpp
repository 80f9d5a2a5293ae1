// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drawing/outline.h"

namespace posespace {
namespace {

constexpr int kMargin = 2;  // transparent texels around the painting
constexpr int kMinWorkingSize = 16, kMaxWorkingSize = 4096;
constexpr std::array<std::uint8_t, 3> kInk = {64, 72, 88};

// The share of texel [x, x + 1] that lies right of an edge which runs from left to right (or back)
// within one row: the mean of clamp(x + 1 - X, 0, 1) for X uniform in [left, right].
double ShareRightOf(double left, double right, int x) {
  const double from = x + 1 - right, to = x + 1 - left;
  if (to - from < 1e-9) return std::clamp(to, 0.0, 1.0);
  const auto integral = [](double u) { return u <= 0.0 ? 0.0 : u < 1.0 ? 0.5 * u * u : u - 0.5; };
  return std::clamp((integral(to) - integral(from)) / (to - from), 0.0, 1.0);
}

// Adds an edge to a raster of coverage differences: the sum over x' <= x of row y is the area of
// texel (x, y) on the edges' inner side.  Exact for polygons, so ink is antialiased.
void AddEdge(Point a, Point b, int width, int height, std::vector<float>* differences) {
  if (a.y() == b.y()) return;
  const double sign = a.y() > b.y() ? 1.0 : -1.0;  // the inside is right of edges that run up
  if (a.y() > b.y()) std::swap(a, b);
  const double slope = (b.x() - a.x()) / (b.y() - a.y());
  const int last = std::min(height - 1, static_cast<int>(b.y()));
  for (int y = static_cast<int>(a.y()); y <= last; ++y) {
    const double from = std::max<double>(y, a.y()), to = std::min<double>(y + 1, b.y());
    if (from >= to) continue;
    const auto [left, right] =
        std::minmax({a.x() + slope * (from - a.y()), a.x() + slope * (to - a.y())});
    float* row = differences->data() + static_cast<std::size_t>(y) * width;
    double before = 0.0;
    for (int x = static_cast<int>(left); x < width && before < 1.0; ++x) {
      const double share = ShareRightOf(left, right, x);
      row[x] += static_cast<float>(sign * (to - from) * (share - before));
      before = share;
    }
  }
}

}  // namespace

Texture PaintRings(const Points& outer, std::span<const Points> holes, int working_size) {
  Texture texture;
  if (outer.rows() < 3) return texture;
  working_size = std::clamp(working_size, kMinWorkingSize, kMaxWorkingSize);
  const Point low = outer.colwise().minCoeff().transpose();
  const Point high = outer.colwise().maxCoeff().transpose();
  const Point extent = high - low;
  texture.scale = working_size / extent.maxCoeff();
  texture.origin = low - Point::Constant(kMargin / texture.scale);
  Image& image = texture.image;
  image.width = static_cast<int>(std::ceil(extent.x() * texture.scale)) + 2 * kMargin;
  image.height = static_cast<int>(std::ceil(extent.y() * texture.scale)) + 2 * kMargin;
  const std::size_t texels = static_cast<std::size_t>(image.width) * image.height;

  const auto add_ring = [&](const Points& ring, std::vector<float>* differences) {
    const auto texel_place = [&](Eigen::Index k) -> Point {
      // What a hole has outside the outline's box makes no difference there.
      const Point p = ring.row(k % ring.rows()).transpose();
      return (p.cwiseMax(low).cwiseMin(high) - texture.origin) * texture.scale;
    };
    for (Eigen::Index k = 0; k < ring.rows(); ++k) {
      AddEdge(texel_place(k), texel_place(k + 1), image.width, image.height, differences);
    }
  };
  std::vector<float> filled(texels, 0.0f), cut(texels, 0.0f);
  add_ring(outer, &filled);
  for (const Points& hole : holes) add_ring(hole, &cut);

  // The mean winding number in a texel, whose sign is the ring's orientation: beyond 1 the ring
  // surrounds the texel more than once.
  const auto share = [](double winding) { return std::min(1.0, std::abs(winding)); };
  image.rgba.resize(4 * texels);
  for (int y = 0; y < image.height; ++y) {
    double inside = 0.0, in_holes = 0.0;
    for (int x = 0; x < image.width; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * image.width + x;
      inside += filled[k];
      in_holes += cut[k];
      std::uint8_t* texel = image.at(x, y);
      std::copy(kInk.begin(), kInk.end(), texel);
      const double coverage = share(inside) * (1.0 - share(in_holes));
      texel[3] = static_cast<std::uint8_t>(std::lround(coverage * 255.0));
    }
  }
  return texture;
}

}  // namespace posespace
