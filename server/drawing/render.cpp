// SPDX-License-Identifier: Apache-2.0
#include "drawing/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "drawing/colour_space.h"

namespace posespace {

namespace {

constexpr double kSmallestWeight = 1.0 / 512.0;

// Output coordinates in fixed point.  Edge functions of coordinates within +-2^29 stay below
// 2^62: exact in 64 bits.
constexpr double kSubpixels = 1024.0;
constexpr double kFurthest = 1 << 19;  // output pixels

using Fixed = std::array<std::int64_t, 2>;

Fixed ToFixed(const Point& p, const View& view) {
  Fixed fixed;
  for (int axis = 0; axis < 2; ++axis) {
    const double pixel = (p[axis] - view.origin[axis]) * view.scale;
    fixed[axis] = std::llround(std::clamp(pixel, -kFurthest, kFurthest) * kSubpixels);
  }
  return fixed;
}

std::int64_t FloorDivide(std::int64_t a, std::int64_t b) {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

// cross(b - a, p - a) at pixel centres: origin + x * along_x + y * along_y.
struct EdgeFunction {
  EdgeFunction(const Fixed& a, const Fixed& b) {
    const std::int64_t dx = b[0] - a[0], dy = b[1] - a[1];
    const std::int64_t half = static_cast<std::int64_t>(kSubpixels) / 2;
    along_x = -dy * static_cast<std::int64_t>(kSubpixels);
    along_y = dx * static_cast<std::int64_t>(kSubpixels);
    origin = dx * (half - a[1]) - dy * (half - a[0]);
    // A centre exactly on the edge belongs to the triangle right of it, or below it.
    includes_zero = dy < 0 || (dy == 0 && dx > 0);
  }
  std::int64_t origin, along_x, along_y;
  bool includes_zero;
};

// The pixels [first, last) of a row whose centres lie in the triangle, within [0, width).
std::pair<std::int64_t, std::int64_t> CoveredSpan(const std::array<EdgeFunction, 3>& edges, int y,
                                                  int width) {
  std::int64_t first = 0, last = width;
  for (const EdgeFunction& edge : edges) {
    // Needed: value + x * along_x >= 0.
    const std::int64_t value = edge.origin + y * edge.along_y - (edge.includes_zero ? 0 : 1);
    if (edge.along_x > 0) {
      first = std::max(first, -FloorDivide(value, edge.along_x));
    } else if (edge.along_x < 0) {
      last = std::min(last, FloorDivide(value, -edge.along_x) + 1);
    } else if (value < 0) {
      return {0, 0};
    }
  }
  return {first, last};
}

// A layer that takes part in the picture.
struct ActiveLayer {
  const Points* pose;
  const RenderTexture* texture;
  float weight;
  int level;
  float texel;  // side of the level's texels, drawing pixels
  float pixel;  // side of a pixel of the picture, drawing pixels, over the whole mesh
};

double TotalArea(const Triangles& triangles, const Points& vertices) {
  double twice = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    twice += std::abs(Cross(vertices.row(triangles(t, 0)).transpose(),
                            vertices.row(triangles(t, 1)).transpose(),
                            vertices.row(triangles(t, 2)).transpose()));
  }
  return 0.5 * twice;
}

std::vector<ActiveLayer> ActiveLayers(const Triangles& triangles, const Points& vertices,
                                      std::span<const RenderLayer> layers, const View& view) {
  double total = 0.0, active = 0.0;
  for (const RenderLayer& layer : layers) {
    if (layer.weight > 0.0) total += layer.weight;
    if (layer.weight >= kSmallestWeight) active += layer.weight;
  }
  const double drawn_area = TotalArea(triangles, vertices) * view.scale * view.scale;
  std::vector<ActiveLayer> result;
  for (const RenderLayer& layer : layers) {
    if (!(layer.weight >= kSmallestWeight)) continue;
    const double pixel = std::sqrt(TotalArea(triangles, *layer.pose) / drawn_area);
    const int level = layer.texture->LevelFor(pixel);
    result.push_back({layer.pose, layer.texture, static_cast<float>(layer.weight * total / active),
                      level, layer.texture->TexelSize(level), static_cast<float>(pixel)});
  }
  return result;
}

// What the layers come to at one pixel.
struct MixedPixel {
  Eigen::Array4f colour = Eigen::Array4f::Zero();  // premultiplied linear
  float least_alpha = 1.0f, most_alpha = 0.0f;     // of a layer

  void Add(const Eigen::Array4f& layer, float weight) {
    colour += weight * layer;
    least_alpha = std::min(least_alpha, layer[3]);
    most_alpha = std::max(most_alpha, layer[3]);
  }
  // All layers are opaque there, or none is to be seen.
  bool IsUndisputed() const { return least_alpha > 0.98f || most_alpha < 0.02f; }
};

// How much of a texel is painted that lies so many texels inside an edge.
float Coverage(float texels) { return std::clamp(texels + 0.5f, 0.0f, 1.0f); }

// How far inside an edge a place lies, texels, of what alpha and the measured distance say.  Within
// a texel of the edge alpha is exact until it saturates; measured distances are rough by half a
// texel, but say how much more there is.
float TexelsInside(float alpha, float distance) {
  constexpr float kSaturated = 0.9f;
  const float by_alpha = 2.0f * alpha - 1.0f;
  const float saturation = (std::abs(by_alpha) - kSaturated) / (1.0f - kSaturated);
  const float more = std::max(std::abs(distance) - 0.5f, 0.0f);
  const float near =
      0.5f * by_alpha + std::copysign(std::clamp(saturation, 0.0f, 1.0f) * more, by_alpha);
  return std::lerp(near, distance, std::clamp(std::abs(distance) - 1.0f, 0.0f, 1.0f));
}

// How a triangle shows a layer: the map from pixels to its drawing, beside that of the whole mesh.
class Shape {
 public:
  // A step to the right and one down in the picture, and a pixel's side, all in drawing pixels.
  Shape(const Point& right, const Point& down, float pixel) {
    const Point x = right / double{pixel}, y = down / double{pixel};
    squared_ = (x * x.transpose() + y * y.transpose()).cast<float>();
    area_ = static_cast<float>(std::abs(Cross(Point::Zero(), x, y)));
  }
  // How many times as fast as elsewhere an edge with this normal is crossed in the picture: more
  // where the drawing is shown squeezed, less where it is stretched.
  float Across(const Eigen::Vector2f& inward) const {
    const float length = inward.squaredNorm();
    const float squared = inward.dot(squared_ * inward);
    return std::sqrt(length > 1.0f ? squared / length : squared + (1.0f - length) * area_);
  }

 private:
  Eigen::Matrix2f squared_;
  float area_;
};

// The places in a layer's drawing of a run of pixels.
struct Run {
  Point from, step;
  const Shape* shape;
  Point At(std::size_t pixel) const { return from + static_cast<double>(pixel) * step; }
};

// All that is drawn with.
struct Brush {
  std::vector<ActiveLayer> layers;
  bool crisp = false;  // two layers or more may disagree about what is painted

  // Makes a pixel as opaque as the layers that are painted there, if it is to be painted, in the
  // mean colour of all layers: that of one which is not painted there is that beside.  Where the
  // layers agree it stays as it is, and so do shades fainter than an edge.
  void Sharpen(std::span<const Run> runs, std::size_t index, MixedPixel* pixel) const {
    float covered = 0.0f, inside = 0.0f;  // means over the layers; inside in drawing pixels
    float edge = 0.0f;                    // width of the edge of the mix, drawing pixels
    Eigen::Array4f colour = Eigen::Array4f::Zero();  // opaque
    for (std::size_t k = 0; k < layers.size(); ++k) {
      const ActiveLayer& layer = layers[k];
      const Point place = runs[k].At(index);
      const Eigen::Array4f shown = layer.texture->At(place, layer.level);
      const float alpha = std::min(shown[3], 1.0f);
      colour += layer.weight * (shown + (1.0f - alpha) * layer.texture->ColourBeyond(place));
      const RenderTexture::EdgePlace at = layer.texture->EdgePlaceAt(place);
      const float texels = TexelsInside(alpha, at.inside / layer.texel);
      covered += layer.weight * Coverage(texels);
      inside += layer.weight * layer.texel * texels;
      edge += layer.weight * layer.texel * runs[k].shape->Across(at.inward);
    }
    if (!(covered > 0.0f)) return;
    // As opaque as the mix is where it covers; and opaque where a layer is, whatever the estimate
    // of what edges leave of it.
    constexpr float kNearlyOpaque = 0.9f, kThinnest = 1e-6f;
    const float share = Coverage(inside / std::max(edge, kThinnest)),
                opacity = pixel->colour[3] / covered;
    const float opaque =
        std::clamp((pixel->most_alpha - kNearlyOpaque) / (1.0f - kNearlyOpaque), 0.0f, 1.0f);
    const float dispute = std::min(2.0f * (pixel->most_alpha - pixel->least_alpha), 1.0f);
    pixel->colour = (1.0f - dispute) * (share / covered) * pixel->colour +
                    dispute * share * std::lerp(std::min(opacity, 1.0f), 1.0f, opaque) * colour;
  }
};

// Premultiplied linear picture under construction.
class Canvas {
 public:
  explicit Canvas(const View& view)
      : width_(view.width),
        texels_(static_cast<std::size_t>(view.width) * view.height, Eigen::Array4f::Zero()),
        mixing_(view.width) {}

  // An empty run of pixels to mix layers in; valid until the next call.
  std::span<MixedPixel> Mixing(std::int64_t pixels) {
    std::fill_n(mixing_.begin(), pixels, MixedPixel{});
    return {mixing_.data(), static_cast<std::size_t>(pixels)};
  }

  // Lays a run of pixels over those that begin at (x, y).
  void Over(std::int64_t x, int y, std::span<const MixedPixel> run) {
    Eigen::Array4f* below = texels_.data() + static_cast<std::size_t>(y) * width_ + x;
    for (const MixedPixel& pixel : run) {
      *below = pixel.colour + (1.0f - std::min(pixel.colour[3], 1.0f)) * *below;
      ++below;
    }
  }

  Image ToImage(const View& view) const {
    Image image{view.width, view.height, std::vector<std::uint8_t>(4 * texels_.size(), 0)};
    std::uint8_t* to = image.rgba.data();
    for (const Eigen::Array4f& texel : texels_) {
      const float alpha = std::min(texel[3], 1.0f);
      const auto opacity = static_cast<std::uint8_t>(255.0f * alpha + 0.5f);
      if (opacity > 0) {
        for (int c = 0; c < 3; ++c) to[c] = SrgbFromLinear(texel[c] / texel[3]);
        to[3] = opacity;
      }
      to += 4;
    }
    return image;
  }

 private:
  int width_;
  std::vector<Eigen::Array4f> texels_;
  std::vector<MixedPixel> mixing_;
};

// Draws one triangle: from each layer, the texel at the pixel's barycentric place.
void DrawTriangle(const std::array<int, 3>& corners, const std::vector<Fixed>& fixed,
                  const Brush& brush, const View& view, Canvas* canvas) {
  std::array<int, 3> v = corners;
  const auto twice_area = [&] {
    const Fixed &a = fixed[v[0]], &b = fixed[v[1]], &c = fixed[v[2]];
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  if (twice_area() < 0) std::swap(v[1], v[2]);  // a folded triangle shows its back
  const std::int64_t area = twice_area();
  if (area == 0) return;
  const Fixed &a = fixed[v[0]], &b = fixed[v[1]], &c = fixed[v[2]];

  // Edge k lies opposite corner k, so its function over the area is that corner's weight.
  const std::array<EdgeFunction, 3> edges = {EdgeFunction(b, c), EdgeFunction(c, a),
                                             EdgeFunction(a, b)};
  const auto [low, high] = std::minmax({a[1], b[1], c[1]});
  const auto subpixels = static_cast<std::int64_t>(kSubpixels);
  const std::int64_t first_row = std::max<std::int64_t>(0, FloorDivide(low, subpixels));
  const std::int64_t last_row =
      std::min<std::int64_t>(view.height - 1, FloorDivide(high, subpixels));
  // The place in a pose's drawing of the pixel whose edge functions have these values.
  const auto place_of = [&](const Points& pose, const std::array<double, 3>& values) -> Point {
    return ((values[0] * pose.row(v[0]) + values[1] * pose.row(v[1]) + values[2] * pose.row(v[2])) /
            static_cast<double>(area))
        .transpose();
  };
  const std::array<double, 3> along_x = {static_cast<double>(edges[0].along_x),
                                         static_cast<double>(edges[1].along_x),
                                         static_cast<double>(edges[2].along_x)};
  const std::array<double, 3> along_y = {static_cast<double>(edges[0].along_y),
                                         static_cast<double>(edges[1].along_y),
                                         static_cast<double>(edges[2].along_y)};
  std::vector<Shape> shapes;  // by layer
  for (const ActiveLayer& layer : brush.layers) {
    shapes.emplace_back(place_of(*layer.pose, along_x), place_of(*layer.pose, along_y),
                        layer.pixel);
  }
  std::vector<Run> runs;  // by layer
  for (int y = static_cast<int>(first_row); y <= last_row; ++y) {
    const auto [first, last] = CoveredSpan(edges, y, view.width);
    if (first >= last) continue;
    std::array<double, 3> values;
    for (int k = 0; k < 3; ++k) {
      values[k] =
          static_cast<double>(edges[k].origin + first * edges[k].along_x + y * edges[k].along_y);
    }
    const std::span<MixedPixel> mixed = canvas->Mixing(last - first);
    runs.clear();
    for (std::size_t k = 0; k < brush.layers.size(); ++k) {
      const ActiveLayer& layer = brush.layers[k];
      const Run run{place_of(*layer.pose, values), place_of(*layer.pose, along_x), &shapes[k]};
      for (std::size_t i = 0; i < mixed.size(); ++i) {
        mixed[i].Add(layer.texture->At(run.At(i), layer.level), layer.weight);
      }
      runs.push_back(run);
    }
    for (std::size_t i = 0; brush.crisp && i < mixed.size(); ++i) {
      if (!mixed[i].IsUndisputed()) brush.Sharpen(runs, i, &mixed[i]);
    }
    canvas->Over(first, y, mixed);
  }
}

}  // namespace

View FitView(const Point& low, const Point& high, int width, int height) {
  const Point extent = high - low;
  View view{0.5 * (low + high), std::numeric_limits<double>::infinity(), width, height};
  if (extent.x() > 0.0) view.scale = std::min(view.scale, width / extent.x());
  if (extent.y() > 0.0) view.scale = std::min(view.scale, height / extent.y());
  if (!std::isfinite(view.scale)) view.scale = 1.0;
  view.origin -= 0.5 / view.scale * Point(width, height);
  return view;
}

Image Render(const Triangles& triangles, const Points& vertices,
             std::span<const RenderLayer> layers, const View& view, PaintEdges edges) {
  if (view.width <= 0 || view.height <= 0) return {};
  Canvas canvas(view);
  if (!(view.scale > 0.0) || !std::isfinite(view.scale) || !view.origin.allFinite()) {
    return canvas.ToImage(view);
  }
  Brush brush{ActiveLayers(triangles, vertices, layers, view)};
  brush.crisp = edges == PaintEdges::kCrisp && brush.layers.size() > 1;
  std::vector<Fixed> fixed(vertices.rows());
  for (Eigen::Index k = 0; k < vertices.rows(); ++k) {
    fixed[k] = ToFixed(vertices.row(k).transpose(), view);
  }
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const std::array<int, 3> corners = {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    DrawTriangle(corners, fixed, brush, view, &canvas);
  }
  return canvas.ToImage(view);
}

}  // namespace posespace
