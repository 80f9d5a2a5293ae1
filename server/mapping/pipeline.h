// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_PIPELINE_H_
#define POSESPACE_MAPPING_PIPELINE_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/boundary_matching.h"
#include "mapping/boundary_simplification.h"
#include "mapping/compatible_triangulation.h"
#include "mapping/mesh_improvement.h"

namespace posespace {

struct MappingOptions {
  MatchingOptions matching;
  SimplificationOptions simplification;
  TriangulationOptions triangulation;
  ImprovementOptions improvement;
};

struct MappingReport {
  int outline_vertices = 0;        // rows of the simplified outlines
  int steiner_vertices = 0;        // added by triangulation, before refinement
  LevelCounts levels;              // which level of the triangulation solved how many parts
  double min_angle = 0.0;          // of the final mesh, radians
  std::vector<double> confidence;  // per drawing, as in MatchedOutlines
  std::vector<std::pair<std::string, double>> seconds;  // stage -> seconds, in order
  // Ghost loss before and after interior alignment: of all drawings together, then of each (N + 1
  // values).  Empty when there was none; MapShapes leaves them so.
  std::vector<double> ghosts_before, ghosts_after;
};

struct Mapping {
  CompatibleMesh mesh;
  MappingReport report;
  FlipProposal proposal;             // as in MatchedOutlines
  std::optional<Mismatch> mismatch;  // the same
  std::optional<MissedCorners> missed_corners;
};

// N drawings -> one mesh that is valid in all of them (paper, section 3): outlines are matched,
// simplified together, triangulated compatibly, and the mesh improved.  Reports fractions of the
// whole to `progress`, in stages "matching", "simplification", "triangulation", "improvement".
// The order of the drawings changes nothing but the order of the poses.
//
// Fails with what the stages fail with; the final mesh is verified by exact predicates, and a
// defect is reported as kInternal rather than handed on.
Result<Mapping> MapShapes(std::span<const MatchingShape> shapes,
                          std::span<const Landmark> landmarks = {},
                          const MappingOptions& options = {}, Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_PIPELINE_H_
