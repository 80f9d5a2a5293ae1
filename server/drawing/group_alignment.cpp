// SPDX-License-Identifier: Apache-2.0
#include "drawing/group_alignment.h"

#include <utility>

#include "drawing/ghost_loss.h"
#include "drawing/local_difference.h"
#include "drawing/paint_filling.h"

namespace posespace {
namespace {

constexpr int kRounds = 3;  // of measuring and moving; later ones change little

// What is looked at to say whether a move helped: deviation, / raster size.
constexpr double kWindow = 16.0 / 512.0;

// Less ghost loss taken away is not worth rounder triangles.
constexpr double kLeastGain = 0.05;

Error Cancelled() { return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}}; }

void Warp(const Comparison& comparison, std::size_t k, AlignmentGroup* group) {
  group->pictures[k] =
      FillBeyondPaint(comparison.Warp(group->members[k], group->moving[k].moves.pose()));
}

Result<void> MoveTogether(const Comparison& comparison, AlignmentGroup* group, Progress* progress) {
  const std::size_t count = group->members.size();
  const double window = kWindow * comparison.size();
  const auto before = LocalDifferences(group->unaligned, group->painted, window);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Points> wanted = {group->moving[0].field};
    Points mean = wanted[0] / static_cast<double>(count);
    for (std::size_t k = 1; k < count; ++k) {
      if (IsCancelled(progress)) return Cancelled();
      wanted.push_back(
          comparison.FieldTowards(group->pictures[0], group->pictures[k], group->moving[k]));
      mean += wanted[k] / static_cast<double>(count);
      Report(progress, (round + (k + 1.0) / static_cast<double>(count)) / (kRounds + 1.0));
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (IsCancelled(progress)) return Cancelled();
      comparison.Move(group->members[k], wanted[k] - mean, &group->moving[k]);
      Warp(comparison, k, group);
    }
    const auto after = LocalDifferences(group->pictures, group->painted, window);
    for (std::size_t k = 0; k < count; ++k) {
      if (IsCancelled(progress)) return Cancelled();
      const cv::Mat1f share = ShareToKeep(before[k], after[k]);
      const Points kept = comparison.Scaled(group->moving[k].field, share);
      comparison.Move(group->members[k], kept, &group->moving[k]);
      Warp(comparison, k, group);
    }
  }
  return {};
}

// By member: whether the group has less ghosts with it aligned than not.
Result<std::vector<char>> WhomItHelps(const AlignmentGroup& group, const Progress* progress) {
  std::vector<cv::Mat3f> pictures = group.pictures;
  const double together = MeasureGhosts(pictures, group.painted).all;
  std::vector<char> helps(pictures.size(), 1);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    if (IsCancelled(progress)) return Cancelled();
    const cv::Mat3f aligned = std::exchange(pictures[k], group.unaligned[k]);
    helps[k] = MeasureGhosts(pictures, group.painted).all > together ? 1 : 0;
    pictures[k] = aligned;
  }
  return helps;
}

}  // namespace

Result<void> AlignGroup(const Comparison& comparison, AlignmentGroup* group, Progress* progress) {
  group->pictures = group->unaligned;
  group->moving.clear();
  for (const int i : group->members) group->moving.push_back(comparison.Unmoved(i));
  if (group->members.size() < 2) return {};
  TRY(MoveTogether(comparison, group, progress));

  const auto take_back = [&](std::size_t k) {
    group->moving[k] = comparison.Unmoved(group->members[k]);
    group->pictures[k] = group->unaligned[k];
  };
  const std::vector<char> helps = TRY(WhomItHelps(*group, progress));
  for (std::size_t k = 0; k < helps.size(); ++k) {
    if (helps[k] == 0) take_back(k);
  }
  const double before = MeasureGhosts(group->unaligned, group->painted).all;
  const double after = MeasureGhosts(group->pictures, group->painted).all;
  if (after < (1.0 - kLeastGain) * before) return {};
  for (std::size_t k = 0; k < helps.size(); ++k) take_back(k);
  return {};
}

}  // namespace posespace
