// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_RENDER_H_
#define POSESPACE_DRAWING_RENDER_H_

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/image.h"
#include "geometry/mesh.h"

namespace posespace {

// A texture made ready for mixing: premultiplied alpha, linear light, float, with its reductions
// to a half, a quarter, ... so that small pictures of it do not shimmer; how far each texel lies
// from the edge of the painting; and roughly, which colours are nearest beyond it.  Immutable;
// share freely.  25 bytes a texel.
class RenderTexture {
 public:
  explicit RenderTexture(const Texture& texture);

  // Premultiplied linear RGBA at a place in drawing pixels, bilinear; transparent outside.
  // Level 0 is the texture itself, each next one half as fine.
  Eigen::Array4f At(const Point& place, int level = 0) const;

  // The level whose texels are nearest in size to pixels of `length` drawing pixels a side.
  int LevelFor(double length) const;

  // The side of that level's texels, drawing pixels.
  float TexelSize(int level) const { return static_cast<float>(1.0 / levels_[level].scale); }

  // Where a place lies to the edge of the painting (edge_distance.h), bilinear.
  struct EdgePlace {
    float inside;            // how far inside, drawing pixels; negative outside
    Eigen::Vector2f inward;  // its gradient: about a unit long, shorter halfway between two edges
  };
  EdgePlace EdgePlaceAt(const Point& place) const;

  // The colour of the painting at a place beyond it, continued smoothly: opaque, linear RGBA.
  Eigen::Array4f ColourBeyond(const Point& place) const;

 private:
  struct Level {
    int width;
    int height;
    double scale;               // texels of this level per drawing pixel
    std::vector<float> texels;  // RGBA
  };

  Point origin_;
  std::vector<Level> levels_;
  std::vector<std::int16_t> edge_distance_;  // of the texels of level 0
  int fill_level_ = 0;                       // whose texels the next ones lie at
  std::vector<float> fill_;                  // RGBA
};

// One pose's part in a picture.
struct RenderLayer {
  const Points* pose;            // V x 2: where the mesh lies in this pose's drawing
  const RenderTexture* texture;  // may be shared with other layers
  double weight;                 // texture weight w''; a layer below 1/512 is skipped, and its
                                 // weight divided among the others
};

// Which part of the plane a picture shows: pixel = (p - origin) * scale.
struct View {
  Point origin = Point::Zero();
  double scale = 1.0;
  int width = 0;
  int height = 0;
};

// The view that shows a box of drawing pixels centred in width x height with its aspect kept.
View FitView(const Point& low, const Point& high, int width, int height);

// What is drawn where some poses are painted and others are not.
enum class PaintEdges {
  // A sharp silhouette: painted where the weighted mean of the poses' distances from their edges
  // says inside.  A stroke between a thin and a thick one has the mean width.
  kCrisp,
  // The mix of paint and transparency: pale ghosts of what only some poses have.
  kSoft,
};

// Draws a mesh with the weighted mix of its poses' pixels.
//
// Each output pixel whose centre lies in a triangle takes, from every layer, the texel at the same
// barycentric place; mixed premultiplied in linear light, delivered as straight sRGB with alpha.
// Triangles share their edges by a top-left rule: no seams, no pixel drawn twice by neighbours;
// where the mesh overlaps itself, later triangles lie on top (where they are transparent, what is
// below shows).  Silhouettes are antialiased by the textures' own alpha, since the mesh encloses
// every painted pixel; where poses disagree, as `edges` says, and nothing changes where they agree
// and are shown in the same shape.  A crisp silhouette is as wide on triangles that are shown
// stretched or squeezed as elsewhere.
// Coverage is decided on vertices rounded to 1/1024 output pixel.  A layer shown smaller than its
// texture is taken from one reduction of it, chosen for the whole mesh.
//
// Requires  vertices V x 2, finite; each layer's pose has V rows.
// Cost      O(pixels covered x layers).  Pure; call from any thread.
Image Render(const Triangles& triangles, const Points& vertices,
             std::span<const RenderLayer> layers, const View& view,
             PaintEdges edges = PaintEdges::kCrisp);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_RENDER_H_
