// SPDX-License-Identifier: Apache-2.0
#include "drawing/alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "drawing/common_pose.h"
#include "drawing/displacement_field.h"
#include "drawing/feature_flow.h"
#include "drawing/ghost_loss.h"
#include "drawing/interior_moves.h"
#include "drawing/paint_filling.h"
#include "drawing/with_opencv.h"

namespace posespace {
namespace {

constexpr int kRounds = 3;  // of measuring and moving; later ones change little
constexpr int kSweeps = 4;  // over the vertices of a round: some wait for their neighbours

// Weight of a vertex against that of an edge, where colours change from 0 to 1 over the size of the
// raster.
constexpr double kFollowing = 0.1;
constexpr double kReach = 6.0 / 512.0;  // of what a vertex looks at (deviation), / raster size

// Less ghost loss than this cannot be seen; less of it taken away is not worth rounder triangles.
constexpr double kInvisible = 1e-3;
constexpr double kLeastGain = 0.05;

Error Cancelled() { return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}}; }

// The aligned vertices of one drawing on their way.
struct Moving {
  InteriorMoves moves;
  Points field;  // V x 2, raster pixels: vertex v lies where the drawing was at common_v + field_v
};

// Twice as fine as the finest texture shows everything there is.
int RasterSize(std::span<const ReducedTexture> textures) {
  int longest = 1;
  for (const ReducedTexture& each : textures) {
    longest = std::max({longest, each.width, each.height});
  }
  return std::min(2 * longest, AlignmentSize(static_cast<int>(textures.size())));
}

// What all drawings are compared in.
class Comparison {
 public:
  Comparison(const CompatibleMesh& mesh, const Points& common,
             std::span<const ReducedTexture> textures)
      : mesh_(mesh),
        edges_(EdgesOf(mesh.triangles)),
        size_(RasterSize(textures)),
        raster_(mesh.triangles, common, size_),
        textures_(textures) {}

  bool IsPlain(std::size_t i) const { return textures_[i].plain; }

  cv::Mat4f Warp(std::size_t i, const Points& pose) const {
    return raster_.Warp(pose, textures_[i]);
  }

  // The field that brings the features of a picture, warped by `field`, to where `from` has them.
  Points FieldTowards(const cv::Mat3f& from, const cv::Mat3f& picture, const Moving& moving) const {
    const cv::Mat3f flow = FeatureFlow(from, picture, kReach * size_);
    Points given = moving.field;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(given.rows());
    for (int v = 0; v < given.rows(); ++v) {
      const Point at = raster_.ToRaster(v);
      const int x = std::clamp(static_cast<int>(std::lround(at.x())), 0, flow.cols - 1);
      const int y = std::clamp(static_cast<int>(std::lround(at.y())), 0, flow.rows - 1);
      const Point step(flow(y, x)[0], flow(y, x)[1]);
      const auto there = raster_.Interpolate(at + step, moving.field);
      if (!step.allFinite() || !there) continue;
      given.row(v) = (step + *there).transpose();
      weights[v] = kFollowing * size_ * size_ * flow(y, x)[2];
    }
    return SmoothField(edges_, moving.moves.free(), given, weights);
  }

  // Moves the vertices of drawing i towards `goal` as far as the mesh allows.
  void Move(std::size_t i, const Points& goal, Moving* moving) const {
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

 private:
  const CompatibleMesh& mesh_;
  Edges edges_;
  int size_;  // longer side of the raster, pixels
  CommonPose raster_;
  std::span<const ReducedTexture> textures_;
};

// Takes out of `mask` where a picture is not painted; an empty mask means everywhere.
void KeepPainted(const cv::Mat4f& picture, cv::Mat1b* mask) {
  if (mask->empty()) *mask = cv::Mat1b(picture.size(), 255);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      if (picture(y, x)[3] < 0.5f) (*mask)(y, x) = 0;
    }
  }
}

// The picture that differs least from the others, but for plain ones: they show nothing to go by.
std::size_t Medoid(std::span<const cv::Mat3f> pictures, const Comparison& comparison) {
  std::vector<double> difference(pictures.size(), 0.0);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (comparison.IsPlain(i)) difference[i] = std::numeric_limits<double>::infinity();
  }
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (std::size_t j = i + 1; j < pictures.size(); ++j) {
      const double between = cv::norm(pictures[i], pictures[j], cv::NORM_L1);
      difference[i] += between;
      difference[j] += between;
    }
  }
  return std::min_element(difference.begin(), difference.end()) - difference.begin();
}

// Moves the drawings in rounds, and their `pictures` with them: each along the field that brings it
// to the middlemost one, less the mean of all fields, so that no drawing is special.
Result<void> MoveTogether(const Comparison& comparison, std::vector<Moving>* moving,
                          std::vector<cv::Mat3f>* pictures, Progress* progress) {
  const std::size_t count = moving->size();
  const std::size_t middle = Medoid(*pictures, comparison);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Points> wanted(count);
    Points mean = Points::Zero((*moving)[middle].field.rows(), 2);
    for (std::size_t i = 0; i < count; ++i) {
      if (IsCancelled(progress)) return Cancelled();
      const Moving& each = (*moving)[i];
      wanted[i] = i == middle ? each.field
                              : comparison.FieldTowards((*pictures)[middle], (*pictures)[i], each);
      mean += wanted[i] / static_cast<double>(count);
      Report(progress, (round + (i + 1.0) / static_cast<double>(count)) / (kRounds + 1.0));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (IsCancelled(progress)) return Cancelled();
      comparison.Move(i, wanted[i] - mean, &(*moving)[i]);
      (*pictures)[i] = FillBeyondPaint(comparison.Warp(i, (*moving)[i].moves.pose()));
    }
  }
  return {};
}

// Which drawings fit the others better aligned than not.
Result<std::vector<char>> WhomItHelps(const std::vector<cv::Mat3f>& unaligned,
                                      std::vector<cv::Mat3f> pictures, const cv::Mat1b& painted,
                                      const Progress* progress) {
  const double together = MeasureGhosts(pictures, painted).all;
  std::vector<char> helps(pictures.size(), 1);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (IsCancelled(progress)) return Cancelled();
    const cv::Mat3f aligned = std::exchange(pictures[i], unaligned[i]);
    helps[i] = MeasureGhosts(pictures, painted).all > together ? 1 : 0;
    pictures[i] = aligned;
  }
  return helps;
}

// `result` with its poses aligned and its losses measured.
Result<Alignment> Align(const CompatibleMesh& mesh, const Points& common,
                        std::span<const ReducedTexture> textures, Alignment result,
                        Progress* progress) {
  const std::size_t count = mesh.poses.size();
  const Comparison comparison(mesh, common, textures);
  std::vector<cv::Mat3f> unaligned;
  cv::Mat1b painted;  // in all drawings: what lies beside another drawing is no ghost inside
  std::vector<Moving> moving;
  for (std::size_t i = 0; i < count; ++i) {
    if (IsCancelled(progress)) return Cancelled();
    const cv::Mat4f warped = comparison.Warp(i, mesh.poses[i]);
    unaligned.push_back(FillBeyondPaint(warped));
    KeepPainted(warped, &painted);
    moving.push_back({InteriorMoves(mesh, mesh.poses[i]), Points::Zero(mesh.num_vertices(), 2)});
  }
  const GhostLoss before = MeasureGhosts(unaligned, painted);
  for (std::size_t i = 0; i < count; ++i) result.each[i] = {before.each[i], before.each[i]};
  result.all = {before.all, before.all};
  if (before.all < kInvisible) return result;

  std::vector<cv::Mat3f> pictures = unaligned;
  TRY(MoveTogether(comparison, &moving, &pictures, progress));
  const std::vector<char> helps = TRY(WhomItHelps(unaligned, pictures, painted, progress));
  for (std::size_t i = 0; i < count; ++i) {
    if (helps[i] == 0) pictures[i] = unaligned[i];
  }
  const GhostLoss after = MeasureGhosts(pictures, painted);
  if (!(after.all < (1.0 - kLeastGain) * before.all)) return result;
  for (std::size_t i = 0; i < count; ++i) {
    if (helps[i] != 0) result.poses[i] = moving[i].moves.pose();
    result.each[i].after = after.each[i];
  }
  result.all.after = after.all;
  return result;
}

}  // namespace

int AlignmentSize(int num_drawings) {
  constexpr double kSize = 512.0, kDrawings = 8.0;
  const double share = std::min(1.0, kDrawings / std::max(1, num_drawings));
  return static_cast<int>(kSize * std::sqrt(share));
}

ReducedTexture Reduce(const Texture& texture, int size) {
  const Image& image = texture.image;
  const int block = std::max(1, (std::max(image.width, image.height) + size - 1) / size);
  ReducedTexture reduced;
  reduced.width = (image.width + block - 1) / block;
  reduced.height = (image.height + block - 1) / block;
  reduced.origin = texture.origin;
  reduced.scale = texture.scale / block;
  reduced.rgba.assign(4 * static_cast<std::size_t>(reduced.width) * reduced.height, 0.0f);
  const float share = 1.0f / (255.0f * static_cast<float>(block) * static_cast<float>(block));
  const std::uint8_t* painted = nullptr;
  for (int y = 0; y < image.height; ++y) {
    float* const row = &reduced.rgba[4 * static_cast<std::size_t>(y / block) * reduced.width];
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* const pixel = image.at(x, y);
      if (pixel[3] == 0) continue;
      if (painted == nullptr) painted = pixel;
      reduced.plain = reduced.plain && std::equal(pixel, pixel + 3, painted);
      const float alpha = share * static_cast<float>(pixel[3]);
      float* const texel = row + 4 * (x / block);
      for (int c = 0; c < 3; ++c) texel[c] += alpha * static_cast<float>(pixel[c]) / 255.0f;
      texel[3] += alpha;
    }
  }
  return reduced;
}

Result<Alignment> AlignInteriors(const CompatibleMesh& mesh, const Points& common,
                                 std::span<const ReducedTexture> textures, Progress* progress) {
  const std::size_t count = mesh.poses.size();
  if (textures.size() != count || common.rows() != mesh.num_vertices()) {
    return Error{
        ErrorCode::kSizeMismatch, "textures and common pose are not those of the mesh", {}};
  }
  Alignment result{mesh.poses, {}, std::vector<GhostChange>(count)};
  const bool plain = std::all_of(textures.begin(), textures.end(),
                                 [](const ReducedTexture& each) { return each.plain; });
  if (count < 2 || plain || !common.allFinite()) return result;

  return WithOpenCv([&] { return Align(mesh, common, textures, std::move(result), progress); });
}

}  // namespace posespace
