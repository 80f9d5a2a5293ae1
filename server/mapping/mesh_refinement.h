// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MESH_REFINEMENT_H_
#define POSESPACE_MAPPING_MESH_REFINEMENT_H_

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "mapping/editable_mesh.h"

// Steps that change how fine a mesh is.  Every triangle stays positive in every pose (exact).  The
// length of an edge is in targets: the largest, over poses, of its length / that pose's target.

namespace posespace {

// Per pose, `relative` sizes of the drawing.
std::vector<double> TargetLengths(const CompatibleMesh& mesh, double relative);

// The mean length of the edges.
double MeanEdge(const EditableMesh& mesh, std::span<const double> targets);

// Splits edges in the middle, longest first, until none is longer than `longest` or the mesh has
// `max_vertices`.  Edges stay whole whose split would leave a triangle that is not positive, or one
// sharper (triangle_quality.h) than `sharpest`.
void SplitLongEdges(EditableMesh& mesh, std::span<const double> targets, double longest,
                    double sharpest, int max_vertices, Progress* progress);

// Removes interior vertices with an edge shorter than `shortest` where that leaves no triangle
// sharper than `sharpest`.
void CollapseShortEdges(EditableMesh& mesh, std::span<const double> targets, double shortest,
                        double sharpest, Progress* progress);

// Removes interior vertices at triangles sharper than `sharpest`, sharpest first, where that leaves
// only triangles that are less sharp.
void RemoveAtSharpTriangles(EditableMesh& mesh, double sharpest, Progress* progress);

// Cuts every triangle into four of its shape at the middles of its sides.  Returns false, with the
// mesh as it was, when rounding would leave a triangle that is not positive.
bool QuarterTriangles(CompatibleMesh& mesh);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MESH_REFINEMENT_H_
