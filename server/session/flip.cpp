// SPDX-License-Identifier: Apache-2.0
#include "session/flip.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include "session/digest.h"

namespace posespace {
namespace {

constexpr std::string_view kFlippedVersion = "posespace-flipped/1";

// The mirror image of a ring, of the same orientation.
Points Flipped(const Points& ring, double mirror_sum) {
  Points flipped = ring.colwise().reverse();
  flipped.col(0) = mirror_sum - flipped.col(0).array();
  return flipped;
}

void FlipPixels(Image& image) {
  for (int y = 0; y < image.height; ++y) {
    for (int left = 0, right = image.width - 1; left < right; ++left, --right) {
      std::swap_ranges(image.at(left, y), image.at(left, y) + 4, image.at(right, y));
    }
  }
}

}  // namespace

double MirrorSum(const ShapeSource& source, const Drawing& drawing) {
  const auto* const polygon = std::get_if<PolygonSource>(&source);
  if (polygon == nullptr || !polygon->texture.empty()) return drawing.width;
  return polygon->outer.col(0).minCoeff() + polygon->outer.col(0).maxCoeff();
}

Drawing Flipped(Drawing drawing, double mirror_sum) {
  Outline& outline = drawing.outline;
  outline.outer = Flipped(outline.outer, mirror_sum);
  outline.colours = outline.colours.colwise().reverse().eval();
  for (Points& hole : outline.holes) hole = Flipped(hole, mirror_sum);
  FlipPixels(drawing.texture.image);
  drawing.texture.origin.x() =
      mirror_sum - drawing.texture.origin.x() - drawing.texture.image.width / drawing.texture.scale;
  drawing.flipped = true;
  drawing.digest = FlippedDigest(drawing.digest);
  return drawing;
}

std::string FlippedDigest(const std::string& digest) {
  return Digest(kFlippedVersion).Add(digest).Hex();
}

}  // namespace posespace
