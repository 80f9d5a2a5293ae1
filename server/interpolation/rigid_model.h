// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_RIGID_MODEL_H_
#define POSESPACE_INTERPOLATION_RIGID_MODEL_H_

#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "interpolation/gradient_fit.h"
#include "interpolation/triangle_maps.h"

namespace posespace {

// What a rigid blend interpolates: the poses, measured against a rest shape.  Rotations have their
// whole turns settled, as rigid_blend.h says.
struct RigidModel {
  Triangles triangles;
  VertexParts parts;
  std::vector<Points> poses;
  std::vector<Points> centroids;  // of each pose, a row per part
  TriangleMaps rigid;             // against the mean of the poses
  TriangleMaps paper;             // against pose 0
  std::vector<double> mean_rotations;
  std::vector<int> turns;
};

// Requires and fails  as RigidBlend::Prepare.
Result<RigidModel> MeasurePoses(const CompatibleMesh& mesh, std::vector<int> turns);

// A row per part: the centroid of its area, sum of signed triangle areas times triangle centroids
// over the sum of signed areas; of absolute areas where folds leave less than kLeastSignedArea of
// them.
Points PartCentroids(const Triangles& triangles, const Points& vertices, const VertexParts& parts);

// A solution that folds so much that less than this share of its triangles' areas is left has no
// useful centroid; its triangles then count with their absolute areas.
inline constexpr double kLeastSignedArea = 1e-3;

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_RIGID_MODEL_H_
