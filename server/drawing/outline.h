// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_OUTLINE_H_
#define POSESPACE_DRAWING_OUTLINE_H_

#include <span>
#include <string>
#include <vector>

#include "drawing/image.h"
#include "geometry/mesh.h"
#include "geometry/result.h"

namespace posespace {

struct OutlineOptions {
  int threshold = 128;      // alpha >= threshold is painted, 1 .. 255; applied before scaling
  int working_size = 512;   // the painted part's longer side, working pixels, 64 .. 4096
  int max_points = 20'000;  // of one ring
};

// What the mapping needs of a drawing.
struct Outline {
  Points outer;               // K x 2, simple, positively oriented, drawing pixels
  std::vector<Points> holes;  // simple, negatively oriented; filled by the mesh, kept by alpha
  Eigen::MatrixXd colours;    // K x 3: RGB in [0, 1] just inside outer row k; 0 rows: none
  int holes_filled = 0;
  std::vector<std::string> warnings;  // what was done to the drawing, for a person to read
};

// The outline of what is painted in a picture.
//
// The ring encloses the centre of every painted pixel: it is traced at working size after painting
// has been widened by 2 working pixels.  Detached parts of at least 0.4 % of the painted area are
// joined to the rest by a thin bridge, smaller ones dropped; holes are filled.  Each of these is
// said in `warnings`.  No edge is longer than 1/32 of the working size, so that colours may be
// interpolated between rows.  Moving the drawing within its picture moves the outline with it.
//
// Fails     kOutlineEmpty (no pixel reaches the threshold), kOutlineTooSmall (fewer than 16 painted
//           pixels in one piece), kOutlineTooLong, kInvalidOption (threshold, working_size).
// Cost      a few milliseconds per 512 x 512 working pixels, plus one pass over the picture.
Result<Outline> TraceOutline(const Image& image, const OutlineOptions& options = {});

// The outline given as rings: checked, oriented, repeated and needless points removed.
// Holes are checked (simple, inside the outline, apart from each other), kept in `holes` and
// counted in holes_filled.  Errors name points and edges by the rows that were given.
//
// Fails     kOutlineTooSmall (fewer than 3 distinct points, or an area below 1e-6),
//           kOutlineNotSimple (names both edges and where they meet), kOutlineTooLong (the outline,
//           or all holes together), kInvalidOption (not finite, or a coordinate beyond 1e6).
Result<Outline> OutlineFromRings(const Points& outer, std::span<const Points> holes,
                                 const OutlineOptions& options = {});

// The rings painted in one colour (sRGB, opaque) at working size, antialiased: the texture of a
// polygon that came without a picture.
Texture PaintRings(const Outline& outline, int working_size = 512);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_OUTLINE_H_
