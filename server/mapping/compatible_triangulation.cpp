// SPDX-License-Identifier: Apache-2.0
#include "mapping/compatible_triangulation.h"

#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/decimation.h"
#include "mapping/editable_mesh.h"
#include "mapping/overlay_triangulation.h"
#include "mapping/triangle_quality.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

// Decimation takes most vertices out of an overlay: one this much larger than the limit is tried.
constexpr std::int64_t kMaxDecimation = 4;

std::string Name(std::size_t drawing) { return "drawing " + std::to_string(drawing); }

// True when a simple ring is positively oriented, decided at its lowest corner: that is convex.
bool IsPositivelyOriented(const Points& ring) {
  const Eigen::Index n = ring.rows();
  Eigen::Index lowest = 0;
  for (Eigen::Index k = 1; k < n; ++k) {
    if (std::pair(ring(k, 0), ring(k, 1)) < std::pair(ring(lowest, 0), ring(lowest, 1))) lowest = k;
  }
  return Orientation(ring.row((lowest + n - 1) % n), ring.row(lowest), ring.row((lowest + 1) % n)) >
         0;
}

Result<void> Check(std::span<const Points> outlines, std::span<const int> landmark_rows,
                   const TriangulationOptions& options) {
  if (outlines.empty()) return Error{ErrorCode::kSizeMismatch, "there is no outline", {}};
  const Eigen::Index n = outlines[0].rows();
  for (std::size_t s = 0; s < outlines.size(); ++s) {
    if (outlines[s].rows() == n) continue;
    return Error{ErrorCode::kSizeMismatch,
                 "the outline of " + Name(s) + " has " + std::to_string(outlines[s].rows()) +
                     " rows, that of " + Name(0) + " has " + std::to_string(n),
                 {}};
  }
  for (const int row : landmark_rows) {
    if (0 <= row && row < n) continue;
    return Error{ErrorCode::kSizeMismatch,
                 "landmark row " + std::to_string(row) + " is outside the " + std::to_string(n) +
                     " rows of the outlines",
                 {}};
  }
  if (n > options.max_vertices) {
    return Error{ErrorCode::kMeshTooLarge,
                 "the outlines have " + std::to_string(n) + " rows; the limit is " +
                     std::to_string(options.max_vertices) + " vertices",
                 {}};
  }
  for (std::size_t s = 0; s < outlines.size(); ++s) {
    std::string reason;
    if (!outlines[s].allFinite()) {
      reason = "has a coordinate that is not finite";
    } else if (const auto crossing = FindCrossing(outlines[s])) {
      reason = n < 3 ? "has fewer than 3 rows"
                     : "is not simple: edge " + std::to_string(crossing->first) + " meets edge " +
                           std::to_string(crossing->second);
    } else if (!IsPositivelyOriented(outlines[s])) {
      reason = "is negatively oriented";
    } else {
      continue;
    }
    return Error{ErrorCode::kOutlineNotSimple, "the outline of " + Name(s) + " " + reason, {}};
  }
  return {};
}

CompatibleMesh MeshWithoutSteiner(std::span<const Points> outlines,
                                  const std::vector<Triangle>& triangles) {
  CompatibleMesh mesh;
  mesh.poses.assign(outlines.begin(), outlines.end());
  mesh.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    mesh.triangles.row(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1],
        triangles[t][2];
  }
  mesh.boundary.emplace_back(outlines[0].rows());
  std::iota(mesh.boundary[0].begin(), mesh.boundary[0].end(), 0);
  return mesh;
}

Result<Triangulation> OverlayAndDecimate(std::span<const Points> outlines,
                                         const TriangulationOptions& options, Progress* progress) {
  const int n = static_cast<int>(outlines[0].rows());
  Triangulation result;
  result.used_overlay = true;
  const std::int64_t max_overlay = kMaxDecimation * options.max_vertices;
  result.mesh = TRY(TriangulateByOverlay(outlines, max_overlay, options.seed, progress));
  result.overlay_vertices = result.mesh.num_vertices() - n;
  Report(progress, 0.6);
  EditableMesh editable(result.mesh);
  Decimate(editable, progress);
  result.mesh = editable.Finish();
  if (result.mesh.num_vertices() > options.max_vertices) {
    return Error{ErrorCode::kMeshTooLarge,
                 "the outlines have so little in common that a mesh of all " +
                     std::to_string(outlines.size()) + " takes " +
                     std::to_string(result.mesh.num_vertices()) + " vertices; the limit is " +
                     std::to_string(options.max_vertices),
                 {}};
  }
  result.steiner_vertices = result.mesh.num_vertices() - n;
  return result;
}

}  // namespace

Result<Triangulation> TriangulateCompatibly(std::span<const Points> outlines,
                                            std::span<const int> landmark_rows,
                                            const TriangulationOptions& options,
                                            Progress* progress) {
  if (auto checked = Check(outlines, landmark_rows, options); !checked) {
    return std::move(checked).error();
  }
  const Error cancelled{ErrorCode::kCancelled, "triangulation was cancelled", {}};

  Triangulation result;
  const auto triangles = TriangulateRings(outlines, {}, progress);
  if (IsCancelled(progress)) return cancelled;
  Report(progress, 0.3);
  if (triangles) result.mesh = MeshWithoutSteiner(outlines, *triangles);

  // Slivers without Steiner vertices are worse than Steiner vertices, where those do away with
  // them.
  if (!triangles || SharpestOf(result.mesh) > kSliverSharpness) {
    auto overlaid = OverlayAndDecimate(outlines, options, progress);
    if (IsCancelled(progress)) return cancelled;
    if (!overlaid && !triangles) return std::move(overlaid).error();
    if (overlaid && (!triangles || SharpestOf(overlaid->mesh) < SharpestOf(result.mesh))) {
      result = std::move(*overlaid);
    }
  }
  result.mesh.landmarks.assign(landmark_rows.begin(), landmark_rows.end());
  if (FindDefect(result.mesh)) {
    return Error{ErrorCode::kInternal, "the triangulation folds over", {}};
  }
  Report(progress, 1.0);
  return result;
}

}  // namespace posespace
