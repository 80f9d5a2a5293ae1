// SPDX-License-Identifier: Apache-2.0
#include "mapping/overlay_triangulation.h"

#include <algorithm>
#include <array>
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

// Where a vertex is placed already: on a row (both ends the same) or between the ends of a chord.
struct Place {
  int from = -1, to = -1;
  double t = 0.0;
};

// Places every vertex without a place at the mean of its neighbours (Tutte 1963).  Those of one
// triangle of the outline's own are solved for in its barycentric coordinates, so that a thin
// triangle is as good as any other.
Result<void> PlaceByTutte(const Edges& edges, const std::vector<Place>& places, Points& pose) {
  const int num_vertices = static_cast<int>(places.size());
  const auto is_placed = [&](int v) { return places[v].from >= 0; };
  std::vector<std::vector<int>> neighbours(num_vertices);
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    neighbours[edges(e, 0)].push_back(edges(e, 1));
    neighbours[edges(e, 1)].push_back(edges(e, 0));
  }

  // Vertices that hang together lie in one triangle; what they touch lies on its three sides.
  std::vector<int> unknown(num_vertices, -1);
  std::vector<int> vertices;                // of each unknown
  std::vector<std::array<int, 3>> corners;  // of its triangle
  for (int start = 0; start < num_vertices; ++start) {
    if (is_placed(start) || unknown[start] >= 0) continue;
    const std::size_t begin = vertices.size();
    std::vector<int> touched;
    unknown[start] = static_cast<int>(begin);
    vertices.push_back(start);
    for (std::size_t head = begin; head < vertices.size(); ++head) {
      for (const int w : neighbours[vertices[head]]) {
        if (is_placed(w)) {
          touched.insert(touched.end(), {places[w].from, places[w].to});
        } else if (unknown[w] < 0) {
          unknown[w] = static_cast<int>(vertices.size());
          vertices.push_back(w);
        }
      }
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    if (touched.size() != 3) return Error{ErrorCode::kInternal, "an overlay does not fit", {}};
    corners.resize(vertices.size(), {touched[0], touched[1], touched[2]});
  }
  if (vertices.empty()) return {};

  const int count = static_cast<int>(vertices.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(count, 3);
  for (int row = 0; row < count; ++row) {
    const std::vector<int>& around = neighbours[vertices[row]];
    entries.emplace_back(row, row, static_cast<double>(around.size()));
    for (const int w : around) {
      if (!is_placed(w)) {
        entries.emplace_back(row, unknown[w], -1.0);
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        if (corners[row][k] == places[w].from) rhs(row, k) += 1.0 - places[w].t;
        if (corners[row][k] == places[w].to) rhs(row, k) += places[w].t;
      }
    }
  }
  SparseFactor::Matrix laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const SparseFactor factor = TRY(SparseFactor::Factor(laplacian));
  const Eigen::MatrixXd shares = factor.Solve(rhs);
  for (int row = 0; row < count; ++row) {
    // From the nearest corner, where rounding is least.
    const auto& at = corners[row];
    int nearest = 0;
    shares.row(row).maxCoeff(&nearest);
    const Point origin = pose.row(at[nearest]);
    Point offset = Point::Zero();
    for (int k = 0; k < 3; ++k) {
      offset += shares(row, k) * (Point(pose.row(at[k])) - origin);
    }
    pose.row(vertices[row]) = (origin + offset).transpose();
  }
  return {};
}

// Lays the arrangement into an outline whose own triangulation has `chords`.
Result<Points> Embed(const Points& outline, std::span<const Chord> all_chords,
                     const std::vector<Chord>& chords, const ChordArrangement& arrangement,
                     const Edges& edges) {
  Points pose = Points::Zero(arrangement.num_vertices, 2);
  std::vector<Place> places(arrangement.num_vertices);
  pose.topRows(outline.rows()) = outline;
  for (int row = 0; row < outline.rows(); ++row) places[row] = {row, row, 0.0};
  for (std::size_t c = 0; c < all_chords.size(); ++c) {
    if (!std::binary_search(chords.begin(), chords.end(), all_chords[c])) continue;
    const std::vector<int>& along = arrangement.along[c];
    const double last = static_cast<double>(along.size()) - 1.0;
    for (std::size_t k = 1; k + 1 < along.size(); ++k) {
      const double t = static_cast<double>(k) / last;
      pose.row(along[k]) = (1.0 - t) * pose.row(along.front()) + t * pose.row(along.back());
      places[along[k]] = {along.front(), along.back(), t};
    }
  }
  if (auto result = PlaceByTutte(edges, places, pose); !result) return std::move(result).error();
  return pose;
}

}  // namespace

Result<Overlay> TriangulateByOverlay(std::span<const Points> outlines, std::int64_t max_vertices,
                                     std::uint64_t seed, Progress* progress) {
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
    if (!FindDefect(mesh)) return Overlay{std::move(mesh), draw + 1};
  }
  return Error{ErrorCode::kInternal,
               "the outlines are too thin somewhere for a mesh in double precision",
               {}};
}

}  // namespace posespace
