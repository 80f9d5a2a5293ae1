// SPDX-License-Identifier: Apache-2.0
#include "drawing/comparison.h"

#include <algorithm>
#include <cmath>

#include "drawing/displacement_field.h"
#include "drawing/feature_flow.h"

namespace posespace {
namespace {

constexpr int kSweeps = 4;  // over the vertices: some wait for their neighbours

// Weight of a vertex against that of an edge, where colours change from 0 to 1 over the size of the
// raster.
constexpr double kFollowing = 0.1;
constexpr double kReach = 6.0 / 512.0;  // of what a vertex looks at (deviation), / raster size

// Twice as fine as the finest texture shows everything there is.
int RasterSize(std::span<const ReducedTexture> textures) {
  int longest = 1;
  for (const ReducedTexture& each : textures) {
    longest = std::max({longest, each.width, each.height});
  }
  return std::min(2 * longest, AlignmentSize(static_cast<int>(textures.size())));
}

}  // namespace

Comparison::Comparison(const CompatibleMesh& mesh, const Points& common,
                       std::span<const ReducedTexture> textures)
    : mesh_(mesh),
      textures_(textures),
      edges_(EdgesOf(mesh.triangles)),
      size_(RasterSize(textures)),
      raster_(mesh.triangles, common, size_) {}

Moving Comparison::Unmoved(std::size_t i) const {
  return {InteriorMoves(mesh_, mesh_.poses[i]), Points::Zero(mesh_.num_vertices(), 2)};
}

cv::Mat4f Comparison::Warp(std::size_t i, const Points& pose) const {
  return raster_.Warp(pose, textures_[i]);
}

cv::Point Comparison::PixelOf(int vertex) const {
  const Point at = raster_.ToRaster(vertex);
  return {std::clamp(static_cast<int>(std::lround(at.x())), 0, raster_.size().width - 1),
          std::clamp(static_cast<int>(std::lround(at.y())), 0, raster_.size().height - 1)};
}

Points Comparison::FieldTowards(const cv::Mat3f& from, const cv::Mat3f& picture,
                                const Moving& moving) const {
  const cv::Mat3f flow = FeatureFlow(from, picture, kReach * size_);
  Points given = moving.field;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(given.rows());
  for (int v = 0; v < given.rows(); ++v) {
    const cv::Vec3f& seen = flow(PixelOf(v));
    const Point step(seen[0], seen[1]);
    const auto there = raster_.Interpolate(raster_.ToRaster(v) + step, moving.field);
    if (!step.allFinite() || !there) continue;
    given.row(v) = (step + *there).transpose();
    weights[v] = kFollowing * size_ * size_ * seen[2];
  }
  return SmoothField(edges_, moving.moves.free(), given, weights);
}

void Comparison::Move(std::size_t i, const Points& goal, Moving* moving) const {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int v = 0; v < goal.rows(); ++v) {
      if (moving->moves.free()[v] == 0) continue;
      const Point from = moving->field.row(v).transpose();
      for (const double fraction : {1.0, 0.5, 0.25}) {
        const Point to = from + fraction * (goal.row(v).transpose() - from);
        const auto place = raster_.Interpolate(raster_.ToRaster(v) + to, mesh_.poses[i]);
        if (!place || !moving->moves.Move(v, *place)) continue;
        moving->field.row(v) = to.transpose();
        break;
      }
    }
  }
}

Points Comparison::Scaled(const Points& field, const cv::Mat1f& share) const {
  Points scaled = field;
  for (int v = 0; v < scaled.rows(); ++v) scaled.row(v) *= share(PixelOf(v));
  return scaled;
}

}  // namespace posespace
