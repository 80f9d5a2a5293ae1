// SPDX-License-Identifier: Apache-2.0
#include "drawing/alignment.h"

#include <algorithm>
#include <utility>

#include "drawing/comparison.h"
#include "drawing/ghost_loss.h"
#include "drawing/group_alignment.h"
#include "drawing/group_linking.h"
#include "drawing/kin.h"
#include "drawing/paint_filling.h"
#include "drawing/with_opencv.h"

namespace posespace {
namespace {

constexpr double kInvisible = 1e-3;  // less ghost loss than this cannot be seen

Error Cancelled() { return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}}; }

// The drawings as given, on the raster of the comparison.
struct Pictures {
  std::vector<cv::Mat4f> warped;
  std::vector<cv::Mat3f> filled;
};

// Where all of these drawings are painted.
cv::Mat1b PaintedIn(const Pictures& pictures, std::span<const int> drawings) {
  cv::Mat1b mask(pictures.warped[0].size(), 255);
  for (const int i : drawings) {
    const cv::Mat4f& picture = pictures.warped[i];
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        if (picture(y, x)[3] < 0.5f) mask(y, x) = 0;
      }
    }
  }
  return mask;
}

// The drawings by what they show, but for plain ones: they show nothing to go by.
Result<std::vector<AlignmentGroup>> GroupsOf(const Pictures& pictures,
                                             std::span<const ReducedTexture> textures,
                                             const Progress* progress) {
  std::vector<int> drawings;
  std::vector<cv::Mat3f> filled;
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (textures[i].plain) continue;
    drawings.push_back(static_cast<int>(i));
    filled.push_back(pictures.filled[i]);
  }
  std::vector<AlignmentGroup> groups;
  const auto kindred = TRY(KinOf(filled, PaintedIn(pictures, drawings), progress));
  for (const std::vector<int>& kin : kindred) {
    AlignmentGroup group;
    for (const int k : kin) {
      group.members.push_back(drawings[k]);
      group.unaligned.push_back(filled[k]);
    }
    group.painted = PaintedIn(pictures, group.members);
    groups.push_back(std::move(group));
  }
  return groups;
}

// `result` with its poses aligned and its losses measured.
Result<Alignment> Align(const CompatibleMesh& mesh, const Points& common,
                        std::span<const ReducedTexture> textures, Alignment result,
                        Progress* progress) {
  const std::size_t count = mesh.poses.size();
  const Comparison comparison(mesh, common, textures);
  Pictures pictures;
  std::vector<int> drawings;
  for (std::size_t i = 0; i < count; ++i) {
    if (IsCancelled(progress)) return Cancelled();
    drawings.push_back(static_cast<int>(i));
    pictures.warped.push_back(comparison.Warp(i, mesh.poses[i]));
    pictures.filled.push_back(FillBeyondPaint(pictures.warped[i]));
  }
  const cv::Mat1b painted = PaintedIn(pictures, drawings);
  const GhostLoss before = MeasureGhosts(pictures.filled, painted);
  for (std::size_t i = 0; i < count; ++i) result.each[i] = {before.each[i], before.each[i]};
  result.all = {before.all, before.all};
  if (before.all < kInvisible) return result;

  std::vector<AlignmentGroup> groups = TRY(GroupsOf(pictures, textures, progress));
  const double part = 1.0 / (static_cast<double>(groups.size()) + 1.0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double begin = static_cast<double>(g) * part;
    Progress of_group(progress, begin, begin + part);
    TRY(AlignGroup(comparison, &groups[g], &of_group));
  }
  Progress of_links(progress, 1.0 - part, 1.0);
  TRY(LinkGroups(comparison, painted, &groups, &of_links));
  std::vector<cv::Mat3f> aligned = pictures.filled;
  for (const AlignmentGroup& group : groups) {
    for (std::size_t k = 0; k < group.members.size(); ++k) {
      aligned[group.members[k]] = group.pictures[k];
    }
  }
  const GhostLoss after = MeasureGhosts(aligned, painted);
  if (!(after.all < before.all)) return result;
  for (const AlignmentGroup& group : groups) {
    for (std::size_t k = 0; k < group.members.size(); ++k) {
      result.poses[group.members[k]] = group.moving[k].moves.pose();
    }
  }
  for (std::size_t i = 0; i < count; ++i) result.each[i].after = after.each[i];
  result.all.after = after.all;
  return result;
}

}  // namespace

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
