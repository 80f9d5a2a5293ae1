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

// Fails with kInvalidOption, field threshold, unless the threshold lies in 1 .. 255.
Result<void> CheckThreshold(int threshold);

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

// The same of a texture, in drawing pixels wherever its texels lie.
Result<Outline> TraceOutline(const Texture& texture, const OutlineOptions& options = {});

// The outline given as rings.  What is done to them is said in `warnings`:
//
//   cleaned    repeated points, a first point repeated at the end, and points within straight runs
//              are dropped; either orientation is taken.  The other points are kept as they are.
//   retraced   when a ring crosses or touches itself: the rings are painted, inside by the non-zero
//              rule, and traced as a picture of options.working_size.
//
// Holes are checked (inside the outline, apart from it and from each other), kept in `holes` and
// counted in holes_filled.  Errors name points and edges by the rows that were given, in fields
// outer, outer[17], holes, holes[2], holes[2][5].
//
// Fails     kOutlineTooSmall (fewer than 3 distinct points, or an area below 1e-6),
//           kOutlineNotSimple (a hole that meets another ring: names both edges and where),
//           kOutlineTooLong (the outline, or all holes together), kInvalidOption (not finite, or a
//           coordinate beyond 1e6); when retraced also as TraceOutline.
Result<Outline> OutlineFromRings(const Points& outer, std::span<const Points> holes,
                                 const OutlineOptions& options = {});

// Rings painted in one colour (sRGB, opaque), antialiased: the texture of a polygon that came
// without a picture.  Inside is what the outer ring surrounds and the holes do not, each by the
// non-zero rule, so rings may cross themselves.  The outer ring's longer side gets `working_size`
// texels.  Requires an outer ring of some extent; nothing is painted of fewer than 3 points.
Texture PaintRings(const Points& outer, std::span<const Points> holes, int working_size = 512);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_OUTLINE_H_
