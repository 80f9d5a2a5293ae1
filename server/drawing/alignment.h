// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_ALIGNMENT_H_
#define POSESPACE_DRAWING_ALIGNMENT_H_

#include <span>
#include <vector>

#include "drawing/image.h"
#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

// A texture reduced to what alignment looks at.
struct ReducedTexture {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;  // width x height x 4 in [0, 1]: premultiplied, sRGB as the file has it
  Point origin = Point::Zero();  // texel coordinates = (p - origin) * scale
  double scale = 1.0;
  bool plain = true;  // painted in one colour, or not at all: there is nothing to align
};

// The texture averaged over blocks of pixels, so that neither side exceeds `size`.  Cost: one pass
// over the pixels.
ReducedTexture Reduce(const Texture& texture, int size);

// The size to reduce textures to, and to align at, when there are this many drawings: 512, less for
// more than 8, so that the pictures of a build stay within 200 MB.
int AlignmentSize(int num_drawings);

// How much of the drawings' own detail an even mix of them loses, 0 .. 1: where an eye lies on a
// cheek, both are pale ghosts.  Defined in ghost_loss.h; measured where all drawings are painted.
struct GhostChange {
  double before = 0.0;
  double after = 0.0;
};

struct Alignment {
  std::vector<Points> poses;      // N of V x 2, for the same triangles
  GhostChange all;                // of all drawings together
  std::vector<GhostChange> each;  // N: the part of a drawing's own detail that the mix loses
};

// Moves the inner vertices of a mesh so that the insides of the drawings correspond: eyes meet
// eyes.
//
// All drawings are warped to `common` (V x 2, such as the blend with equal weights); there,
// drawings that show the same are kin (kin.h), as fronts of a figure are, or backs of it, and each
// group of kin is aligned by itself: a face and the back of a head have nothing to bring together;
// then groups, where they do have something in common (group_linking.h).
// Image flow from the one that differs least from its kin says where each one's features lie.  A
// field that follows the flow at features, as far as pictures agree about them, and is smooth
// elsewhere carries the vertices; kin share the way evenly, so that none is bent alone.  A vertex
// keeps its move as far as the colours around it have come closer to those of the kin; a drawing,
// where that lowers the ghost loss of the group; a group, where that falls by a twentieth.  Edges
// of the painting do not count as features.
//
// Boundary vertices and landmarks stay.  Every triangle stays positive in every drawing (exact);
// the star of no vertex has a smaller angle than min(before, 8 degrees); none is stretched or
// squeezed to more than InteriorMoves::kMostStretch times its size, in any direction.  Fewer than
// two drawings, and plain ones, come back as they are.  Equal input gives equal
// output; the order of the drawings changes nothing but rounding.
//
// Requires  a valid mesh; textures reduced to AlignmentSize(N).
// Fails     kSizeMismatch (textures, common), kCancelled.
// Cost      about 0.1 s a drawing at 512 pixels.
// Follows   the open problem of Baxter, Barla, Anjyo 2009, section 6; flow: feature_flow.h.
Result<Alignment> AlignInteriors(const CompatibleMesh& mesh, const Points& common,
                                 std::span<const ReducedTexture> textures,
                                 Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_ALIGNMENT_H_
