// SPDX-License-Identifier: Apache-2.0
#include "mapping/compatible_triangulation.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/cut_triangulation.h"
#include "mapping/decimation.h"
#include "mapping/editable_mesh.h"
#include "mapping/overlay_triangulation.h"
#include "mapping/triangle_quality.h"
#include "mapping/zero_steiner.h"

namespace posespace {
namespace {

// Decimation takes most vertices out of an overlay: larger ones than the limit are tried.
constexpr std::int64_t kMaxOverlay = 32'000;
constexpr std::int64_t kMaxDecimation = 4;
constexpr int kLargeOverlay = 1'000;  // Steiner vertices: decimating several of these takes long

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
                 "the outlines have " + std::to_string(n) + " vertices; the limit is " +
                     std::to_string(options.max_vertices) + "; a larger tolerance leaves fewer",
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

// An outline moved so that its first row is the origin, where doubles lie densest; as it is when
// that would round a coordinate.
Points NearOrigin(const Points& outline) {
  const Eigen::RowVector2d first = outline.row(0);
  Points moved = outline;
  moved.rowwise() -= first;
  for (Eigen::Index k = 0; k < outline.size(); ++k) {
    const double given = outline.data()[k], by = first[k % 2], now = moved.data()[k];
    // Exact if and only if both hold (Knuth's two-sum has no error term).
    if (now + by != given || given - now != by) return outline;
  }
  return moved;
}

// The mesh with its outlines at their own places again.
void MoveBack(std::span<const Points> outlines, CompatibleMesh& mesh) {
  for (std::size_t s = 0; s < outlines.size(); ++s) {
    Points& pose = mesh.poses[s];
    const Eigen::RowVector2d by = outlines[s].row(0) - pose.row(0);
    pose.rowwise() += by;
    pose.topRows(outlines[s].rows()) = outlines[s];
  }
}

// A mesh of Steiner vertices from [n, ..) on, with the level that each comes from.
Triangulation Decimated(const CompatibleMesh& mesh, std::span<const Level> origin,
                        Progress* progress) {
  const int n = mesh.num_vertices() - static_cast<int>(origin.size());
  EditableMesh editable(mesh);
  Decimate(editable, progress);
  Triangulation result;
  result.mesh = editable.Finish();
  result.before_decimation = static_cast<int>(origin.size());
  result.steiner_vertices = result.mesh.num_vertices() - n;
  for (std::size_t v = 0; v < origin.size(); ++v) {
    if (!editable.IsLive(n + static_cast<int>(v))) continue;
    ++result.levels[static_cast<std::size_t>(origin[v])].steiner_vertices;
  }
  return result;
}

Result<Triangulation> CutAndDecimate(std::span<const Points> outlines, std::int64_t max_vertices,
                                     std::uint64_t seed, Progress* progress) {
  const CutTriangulation cut = TRY(TriangulateByCuts(outlines, max_vertices, seed, progress));
  Triangulation result = Decimated(cut.mesh, cut.origin, progress);
  for (std::size_t level = 0; level < kNumLevels; ++level) {
    result.levels[level].parts = cut.parts[level];
  }
  return result;
}

Result<Triangulation> OverlayAndDecimate(std::span<const Points> outlines,
                                         std::int64_t max_vertices, std::uint64_t seed,
                                         Progress* progress) {
  const CompatibleMesh overlay =
      TRY(TriangulateByOverlay(outlines, max_vertices, seed, progress)).mesh;
  const std::vector<Level> origin(overlay.num_vertices() - outlines[0].rows(), Level::kOverlay);
  Triangulation result = Decimated(overlay, origin, progress);
  result.levels[static_cast<std::size_t>(Level::kOverlay)].parts = 1;
  return result;
}

// The overlay of the outlines from number `first` on, going round.
Result<Triangulation> OverlayFrom(std::size_t first, std::span<const Points> outlines,
                                  std::int64_t max_vertices, std::uint64_t seed,
                                  Progress* progress) {
  std::vector<Points> turned(outlines.begin(), outlines.end());
  std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
  Triangulation result = TRY(OverlayAndDecimate(turned, max_vertices, seed, progress));
  std::vector<Points>& poses = result.mesh.poses;
  std::rotate(poses.begin(), poses.end() - static_cast<std::ptrdiff_t>(first), poses.end());
  return result;
}

// Slivers first: they are worse than Steiner vertices, where those do away with them.
bool IsBetter(const Triangulation& a, const Triangulation& b) {
  const double sharpness_a = SharpestOf(a.mesh), sharpness_b = SharpestOf(b.mesh);
  const bool sliver_a = sharpness_a > kSliverSharpness, sliver_b = sharpness_b > kSliverSharpness;
  if (sliver_a != sliver_b) return sliver_b;
  if (!sliver_a && a.steiner_vertices != b.steiner_vertices) {
    return a.steiner_vertices < b.steiner_vertices;
  }
  return sharpness_a < sharpness_b;
}

// The best of the ways that need Steiner vertices.
Result<Triangulation> WithSteiner(std::span<const Points> outlines, bool may_cut,
                                  const TriangulationOptions& options, Progress* progress) {
  const std::int64_t max_vertices = std::max(kMaxOverlay, kMaxDecimation * options.max_vertices);
  std::optional<Triangulation> best;
  if (may_cut) {
    auto cut = CutAndDecimate(outlines, max_vertices, options.seed, progress);
    if (cut) best = std::move(*cut);
    Report(progress, 0.6);
  }
  // The outline that is triangulated first shapes the chords of all others: each may be that one.
  for (std::size_t first = 0; first < outlines.size(); ++first) {
    auto overlaid = OverlayFrom(first, outlines, max_vertices, options.seed, progress);
    if (!overlaid && !best) return std::move(overlaid).error();
    if (!overlaid) break;
    const bool is_large = overlaid->before_decimation > kLargeOverlay;
    if (!best || IsBetter(*overlaid, *best)) best = std::move(*overlaid);
    if (is_large) break;
  }
  if (best->mesh.num_vertices() > options.max_vertices) {
    return Error{ErrorCode::kMeshTooLarge,
                 "the outlines have so little in common that a mesh of all " +
                     std::to_string(outlines.size()) + " takes " +
                     std::to_string(best->mesh.num_vertices()) + " vertices; the limit is " +
                     std::to_string(options.max_vertices),
                 {}};
  }
  return std::move(*best);
}

// The same, worked out where vertices have the most room; only the few that are left after
// decimation are rounded to the outlines' own places.
Result<Triangulation> WithSteinerNearOrigin(std::span<const Points> outlines, bool may_cut,
                                            const TriangulationOptions& options,
                                            Progress* progress) {
  std::vector<Points> moved;
  for (const Points& outline : outlines) moved.push_back(NearOrigin(outline));
  Triangulation result = TRY(WithSteiner(moved, may_cut, options, progress));
  MoveBack(outlines, result.mesh);
  if (FindDefect(result.mesh)) {
    return Error{ErrorCode::kInternal,
                 "the outlines are too thin somewhere for a mesh in double precision",
                 {}};
  }
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

  std::optional<Triangulation> best;
  const auto triangles = TriangulateRings(outlines, {}, progress);
  if (IsCancelled(progress)) return cancelled;
  Report(progress, 0.3);
  if (triangles) {
    best.emplace().mesh = MeshWithoutSteiner(outlines, *triangles);
    best->levels[static_cast<std::size_t>(Level::kZeroSteiner)].parts = 1;
  }
  if (!best || SharpestOf(best->mesh) > kSliverSharpness) {
    auto other = WithSteinerNearOrigin(outlines, !best, options, progress);
    if (IsCancelled(progress)) return cancelled;
    if (!other && !best) return std::move(other).error();
    if (other && (!best || IsBetter(*other, *best))) best = std::move(*other);
  }
  Triangulation& result = *best;
  result.mesh.landmarks.assign(landmark_rows.begin(), landmark_rows.end());
  if (FindDefect(result.mesh)) {
    return Error{ErrorCode::kInternal, "the triangulation folds over", {}};
  }
  Report(progress, 1.0);
  return std::move(result);
}

}  // namespace posespace
