// SPDX-License-Identifier: Apache-2.0
#include "mapping/cut_triangulation.h"

#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "mapping/cut_stages.h"
#include "mapping/overlay_triangulation.h"

namespace posespace {
namespace {

// A mesh under construction; parts are lists of its vertices, in order around them.
class PartByPart {
 public:
  explicit PartByPart(std::span<const Points> outlines)
      : num_rows_(static_cast<int>(outlines[0].rows())), poses_(outlines.size()) {
    for (std::size_t s = 0; s < outlines.size(); ++s) {
      for (int k = 0; k < num_rows_; ++k) poses_[s].emplace_back(outlines[s].row(k));
    }
  }

  int num_vertices() const { return static_cast<int>(poses_[0].size()); }

  std::vector<Points> RingsOf(const std::vector<int>& part) const {
    std::vector<Points> rings;
    for (const std::vector<Point>& pose : poses_) {
      Points& ring = rings.emplace_back(static_cast<Eigen::Index>(part.size()), 2);
      for (std::size_t k = 0; k < part.size(); ++k) {
        ring.row(static_cast<Eigen::Index>(k)) = pose[part[k]].transpose();
      }
    }
    return rings;
  }

  // Adds rows [from, end) of each pose as Steiner vertices of `level`.
  void AddVertices(const std::vector<Points>& poses, Eigen::Index from, Level level) {
    for (std::size_t s = 0; s < poses.size(); ++s) {
      for (Eigen::Index v = from; v < poses[s].rows(); ++v) poses_[s].emplace_back(poses[s].row(v));
    }
    result_.origin.resize(num_vertices() - num_rows_, level);
  }

  // Adds triangles given in indices of `vertices`.
  template <typename Corners>
  void AddTriangle(const std::vector<int>& vertices, const Corners& corners) {
    triangles_.push_back({vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]});
  }

  void Count(Level level) { ++result_.parts[static_cast<std::size_t>(level)]; }

  CutTriangulation Finish() && {
    std::vector<int> all(num_vertices());
    std::iota(all.begin(), all.end(), 0);
    CompatibleMesh& mesh = result_.mesh;
    mesh.poses = RingsOf(all);
    mesh.triangles.resize(static_cast<Eigen::Index>(triangles_.size()), 3);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      mesh.triangles.row(static_cast<Eigen::Index>(t)) << triangles_[t][0], triangles_[t][1],
          triangles_[t][2];
    }
    all.resize(num_rows_);
    mesh.boundary.push_back(std::move(all));
    return std::move(result_);
  }

 private:
  int num_rows_;
  std::vector<std::vector<Point>> poses_;
  std::vector<Triangle> triangles_;
  CutTriangulation result_;
};

}  // namespace

Result<CutTriangulation> TriangulateByCuts(std::span<const Points> outlines,
                                           std::int64_t max_vertices, std::uint64_t seed,
                                           Progress* progress) {
  const int n = static_cast<int>(outlines[0].rows());
  PartByPart mesh(outlines);
  std::vector<std::vector<int>> open(1, std::vector<int>(n));  // parts without a triangulation
  std::iota(open[0].begin(), open[0].end(), 0);
  for (int cuts = 0; !open.empty(); ++cuts) {
    const std::vector<int> part = std::move(open.back());
    open.pop_back();
    const std::vector<Points> rings = mesh.RingsOf(part);
    const auto cut = cuts < n ? FindCut(rings, progress) : std::nullopt;
    if (IsCancelled(progress)) {
      return Error{ErrorCode::kCancelled, "triangulation was cancelled", {}};
    }
    std::vector<int> vertices = part;  // and the new ones
    if (!cut) {
      const std::int64_t left = max_vertices - mesh.num_vertices();
      const CompatibleMesh overlay = TRY(TriangulateByOverlay(rings, left, seed, progress)).mesh;
      for (int v = static_cast<int>(part.size()); v < overlay.num_vertices(); ++v) {
        vertices.push_back(mesh.num_vertices() + v - static_cast<int>(part.size()));
      }
      mesh.AddVertices(overlay.poses, static_cast<Eigen::Index>(part.size()), Level::kOverlay);
      for (int t = 0; t < overlay.num_triangles(); ++t) {
        mesh.AddTriangle(vertices, overlay.triangles.row(t));
      }
      mesh.Count(Level::kOverlay);
      continue;
    }
    for (Eigen::Index b = 0; b < cut->bends[0].rows(); ++b) {
      vertices.push_back(mesh.num_vertices() + static_cast<int>(b));
    }
    mesh.AddVertices(cut->bends, 0, cut->level);
    mesh.Count(cut->level);
    for (const CutSide& side : cut->sides) {
      std::vector<int> rows;
      for (const int row : side.rows) rows.push_back(vertices[row]);
      if (!side.triangles) {
        open.push_back(std::move(rows));
        continue;
      }
      for (const Triangle& corners : *side.triangles) mesh.AddTriangle(rows, corners);
      mesh.Count(Level::kZeroSteiner);
    }
  }
  return std::move(mesh).Finish();
}

}  // namespace posespace
