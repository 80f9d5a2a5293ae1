// SPDX-License-Identifier: Apache-2.0
#include "drawing/group_linking.h"

#include <opencv2/imgproc.hpp>
#include <utility>

#include "drawing/ghost_loss.h"
#include "drawing/local_difference.h"
#include "drawing/paint_filling.h"

namespace posespace {
namespace {

constexpr int kRounds = 2;              // of measuring and moving
constexpr double kWindow = 16.0 / 512;  // surroundings: deviation, / raster size

// Less ghost loss taken away is not worth moving drawings that mostly do not correspond.
constexpr double kLeastGain = 0.02;

Error Cancelled() { return Error{ErrorCode::kCancelled, "the alignment was cancelled", {}}; }

// What stands out from its surroundings: the same on a light coat and on a dark one.
cv::Mat3f DetailsOf(const cv::Mat3f& picture, double window) {
  cv::Mat3f around;
  cv::GaussianBlur(picture, around, {}, window, 0, cv::BORDER_REPLICATE);
  return picture - around;
}

std::vector<cv::Mat1f> LeadersDifferences(const std::vector<AlignmentGroup>& groups,
                                          const cv::Mat1b& painted, double window) {
  std::vector<cv::Mat3f> details;
  for (const AlignmentGroup& group : groups) {
    details.push_back(DetailsOf(group.pictures[0], window));
  }
  return LocalDifferences(details, painted, window);
}

// Moves a member of a group along a field, added to the one that it had.
void MoveBy(const Comparison& comparison, const Points& way, const AlignmentGroup& from,
            std::size_t k, AlignmentGroup* group) {
  const int i = group->members[k];
  comparison.Move(i, from.moving[k].field + way, &group->moving[k]);
  group->pictures[k] = FillBeyondPaint(comparison.Warp(i, group->moving[k].moves.pose()));
}

double GhostsOf(const std::vector<AlignmentGroup>& groups, const cv::Mat1b& painted) {
  std::vector<cv::Mat3f> pictures;
  for (const AlignmentGroup& group : groups) {
    pictures.insert(pictures.end(), group.pictures.begin(), group.pictures.end());
  }
  return MeasureGhosts(pictures, painted).all;
}

// Moves the first members of the groups in rounds from where they were `given`, then their kin.
Result<void> MoveTogether(const Comparison& comparison, const cv::Mat1b& painted,
                          const std::vector<AlignmentGroup>& given,
                          std::vector<AlignmentGroup>* groups, Progress* progress) {
  const double window = kWindow * comparison.size();
  const auto before = LeadersDifferences(given, painted, window);
  const double share = 1.0 / static_cast<double>(given.size());
  for (int round = 0; round < kRounds; ++round) {
    const AlignmentGroup& first = groups->front();
    std::vector<Points> ways = {first.moving[0].field - given[0].moving[0].field};
    Points mean = share * ways[0];
    for (std::size_t g = 1; g < given.size(); ++g) {
      if (IsCancelled(progress)) return Cancelled();
      const AlignmentGroup& group = (*groups)[g];
      ways.push_back(
          comparison.FieldTowards(first.pictures[0], group.pictures[0], group.moving[0]) -
          given[g].moving[0].field);
      mean += share * ways[g];
      Report(progress, (round + static_cast<double>(g) * share) / kRounds);
    }
    for (std::size_t g = 0; g < given.size(); ++g) {
      if (IsCancelled(progress)) return Cancelled();
      MoveBy(comparison, ways[g] - mean, given[g], 0, &(*groups)[g]);
    }
    const auto after = LeadersDifferences(*groups, painted, window);
    for (std::size_t g = 0; g < given.size(); ++g) {
      if (IsCancelled(progress)) return Cancelled();
      const Points way = (*groups)[g].moving[0].field - given[g].moving[0].field;
      MoveBy(comparison, comparison.Scaled(way, ShareToKeep(before[g], after[g])), given[g], 0,
             &(*groups)[g]);
    }
  }
  for (std::size_t g = 0; g < given.size(); ++g) {
    AlignmentGroup& group = (*groups)[g];
    const Points way = group.moving[0].field - given[g].moving[0].field;
    for (std::size_t k = 1; k < group.members.size(); ++k) {
      if (IsCancelled(progress)) return Cancelled();
      MoveBy(comparison, way, given[g], k, &group);
    }
  }
  return {};
}

}  // namespace

Result<void> LinkGroups(const Comparison& comparison, const cv::Mat1b& painted,
                        std::vector<AlignmentGroup>* groups, Progress* progress) {
  if (groups->size() < 2) return {};
  const std::vector<AlignmentGroup> given = *groups;
  TRY(MoveTogether(comparison, painted, given, groups, progress));

  const double together = GhostsOf(*groups, painted);
  std::vector<char> helps;
  for (std::size_t g = 0; g < given.size(); ++g) {
    if (IsCancelled(progress)) return Cancelled();
    const auto linked = std::exchange((*groups)[g].pictures, given[g].pictures);
    helps.push_back(GhostsOf(*groups, painted) > together ? 1 : 0);
    (*groups)[g].pictures = linked;
  }
  for (std::size_t g = 0; g < given.size(); ++g) {
    if (helps[g] == 0) (*groups)[g] = given[g];
  }
  if (!(GhostsOf(*groups, painted) < (1.0 - kLeastGain) * GhostsOf(given, painted))) {
    *groups = given;
  }
  return {};
}

}  // namespace posespace
