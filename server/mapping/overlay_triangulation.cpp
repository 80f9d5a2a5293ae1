// SPDX-License-Identifier: Apache-2.0
#include "mapping/overlay_triangulation.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/sparse_factor.h"
#include "mapping/chord_arrangement.h"
#include "mapping/outline_chords.h"

namespace posespace {
namespace {

constexpr int kMaxDraws = 20;

Triangles FanTriangles(const std::vector<std::vector<int>>& faces) {
  Eigen::Index count = 0;
  for (const std::vector<int>& face : faces) count += static_cast<Eigen::Index>(face.size()) - 2;
  Triangles triangles(count, 3);
  Eigen::Index row = 0;
  for (const std::vector<int>& face : faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      triangles.row(row++) << face[0], face[k - 1], face[k];
    }
  }
  return triangles;
}

// Places every vertex without a place at the mean of its neighbours (Tutte 1963).
Result<void> PlaceByTutte(const Edges& edges, const std::vector<char>& placed, Points& pose) {
  std::vector<int> unknown(placed.size(), -1);
  int count = 0;
  for (std::size_t v = 0; v < placed.size(); ++v) {
    if (!placed[v]) unknown[v] = count++;
  }
  if (count == 0) return {};
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(count, 2);
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    for (const auto& [v, w] :
         {std::pair(edges(e, 0), edges(e, 1)), std::pair(edges(e, 1), edges(e, 0))}) {
      if (unknown[v] < 0) continue;
      entries.emplace_back(unknown[v], unknown[v], 1.0);
      if (unknown[w] >= 0) {
        entries.emplace_back(unknown[v], unknown[w], -1.0);
      } else {
        rhs.row(unknown[v]) += pose.row(w);
      }
    }
  }
  SparseFactor::Matrix laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const SparseFactor factor = TRY(SparseFactor::Factor(laplacian));
  const Eigen::MatrixXd solution = factor.Solve(rhs);
  for (std::size_t v = 0; v < placed.size(); ++v) {
    if (unknown[v] >= 0) pose.row(static_cast<Eigen::Index>(v)) = solution.row(unknown[v]);
  }
  return {};
}

// Lays the arrangement into an outline whose own triangulation has `chords`.
Result<Points> Embed(const Points& outline, std::span<const Chord> all_chords,
                     const std::vector<Chord>& chords, const ChordArrangement& arrangement,
                     const Edges& edges) {
  Points pose = Points::Zero(arrangement.num_vertices, 2);
  std::vector<char> placed(arrangement.num_vertices, 0);
  pose.topRows(outline.rows()) = outline;
  std::fill_n(placed.begin(), outline.rows(), 1);
  for (std::size_t c = 0; c < all_chords.size(); ++c) {
    if (!std::binary_search(chords.begin(), chords.end(), all_chords[c])) continue;
    const std::vector<int>& along = arrangement.along[c];
    const double last = static_cast<double>(along.size()) - 1.0;
    for (std::size_t k = 1; k + 1 < along.size(); ++k) {
      const double t = static_cast<double>(k) / last;
      pose.row(along[k]) = (1.0 - t) * pose.row(along.front()) + t * pose.row(along.back());
      placed[along[k]] = 1;
    }
  }
  if (auto result = PlaceByTutte(edges, placed, pose); !result) return std::move(result).error();
  return pose;
}

}  // namespace

Result<CompatibleMesh> TriangulateByOverlay(std::span<const Points> outlines,
                                            std::int64_t max_vertices, std::uint64_t seed,
                                            Progress* progress) {
  const int n = static_cast<int>(outlines[0].rows());
  const Error cancelled{ErrorCode::kCancelled, "triangulation was cancelled", {}};

  const std::vector<std::vector<Chord>> chords_of = ChooseChords(outlines, progress);
  if (IsCancelled(progress)) return cancelled;
  std::vector<Chord> chords;
  for (const std::vector<Chord>& own : chords_of) {
    chords.insert(chords.end(), own.begin(), own.end());
  }
  std::sort(chords.begin(), chords.end());
  chords.erase(std::unique(chords.begin(), chords.end()), chords.end());
  const std::int64_t vertices = n + CountCrossings(chords);
  if (vertices > max_vertices) {
    return Error{ErrorCode::kMeshTooLarge,
                 "the outlines have so little in common that an overlay of all " +
                     std::to_string(outlines.size()) + " takes " + std::to_string(vertices) +
                     " vertices; the limit is " + std::to_string(max_vertices),
                 {}};
  }

  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const auto arrangement = ArrangeChords(n, chords, seed + static_cast<std::uint64_t>(draw));
    if (!arrangement) continue;
    CompatibleMesh mesh;
    mesh.triangles = FanTriangles(arrangement->faces);
    mesh.boundary.emplace_back(n);
    std::iota(mesh.boundary[0].begin(), mesh.boundary[0].end(), 0);
    const Edges edges = EdgesOf(mesh.triangles);
    for (std::size_t s = 0; s < outlines.size(); ++s) {
      if (IsCancelled(progress)) return cancelled;
      mesh.poses.push_back(TRY(Embed(outlines[s], chords, chords_of[s], *arrangement, edges)));
    }
    if (!FindDefect(mesh)) return mesh;
  }
  return Error{ErrorCode::kInternal,
               "the outlines are too thin somewhere for a mesh in double precision",
               {}};
}

}  // namespace posespace
