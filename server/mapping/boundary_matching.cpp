// SPDX-License-Identifier: Apache-2.0
#include "mapping/boundary_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "geometry/polygon.h"
#include "mapping/close_matching.h"
#include "mapping/common_rows.h"
#include "mapping/landmark_completion.h"
#include "mapping/landmark_marks.h"
#include "mapping/matching_confidence.h"
#include "mapping/matching_tree.h"
#include "mapping/mirror_symmetry.h"
#include "mapping/missed_corners.h"
#include "mapping/moved_limbs.h"
#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"
#include "mapping/outline_mismatch.h"
#include "mapping/pair_matching.h"
#include "mapping/symmetric_matching.h"

namespace posespace {
namespace {

constexpr double kCoarseShare = 0.5;  // of the progress, when all pairs have been compared
constexpr double kUpright = std::numbers::pi / 4.0;  // marks that turn farther end uprightness
// A match without position this many times cheaper than the upright one shows a turned copy: such
// pairs have up to 0.07, all others of fifty real groups 0.3 or more.
constexpr double kTurnedCopy = 0.15;
constexpr int kMaxCorners =
    100'000;                       // of all outlines together; each becomes a row of every outline
constexpr int kCycleSamples = 64;  // at which direct and composed maps are compared

std::vector<OutlineCurve> CurvesOf(std::span<const MatchingShape> shapes) {
  std::vector<OutlineCurve> curves;
  for (const MatchingShape& shape : shapes) curves.emplace_back(shape.outline, shape.colours);
  return curves;
}

std::vector<std::vector<double>> MirrorSumsOf(const std::vector<OutlineCurve>& curves) {
  std::vector<std::vector<double>> sums;
  for (const OutlineCurve& curve : curves) sums.push_back(FindMirrorSums(curve));
  return sums;
}

// Matches N drawings given in an order that does not depend on the caller's.
class GroupMatching {
 public:
  GroupMatching(std::vector<OutlineCurve> curves, Marks marks, const MatchingOptions& options,
                Progress* progress)
      : curves_(std::move(curves)),
        marks_(std::move(marks)),
        options_(options),
        progress_(progress),
        n_(static_cast<int>(curves_.size())),
        sides_(curves_.begin(), curves_.end()),
        mirror_sums_(MirrorSumsOf(curves_)) {}

  // False when cancelled.
  bool Run() { return ComparePairs() && FillLandmarks() && MatchAlongTree(); }

  // All drawings' rows; the landmark rows are those of marks' landmarks.
  CommonRows Rows() const {
    std::vector<PlacedLandmark> landmarks;
    for (std::size_t l = 0; l < marks_.on.size(); ++l) {
      landmarks.push_back({positions_[l][tree_.root], marks_.on[l]});
    }
    return ShareRows(curves_, maps_, landmarks);
  }

  MatchingEvidence Evidence() const {
    MatchingEvidence evidence{costs_, mirrored_costs_, Eigen::MatrixXd::Zero(n_, n_)};
    for (int i = 0; i < n_; ++i) {
      const OutlineMap to_common = maps_[i].Inverse();
      for (int j = i + 1; j < n_; ++j) {
        double sum = 0.0;
        for (int k = 0; k < kCycleSamples; ++k) {
          const double position = static_cast<double>(k) / kCycleSamples;
          const double turns = maps_[j].At(to_common.At(position)) - Pair(i, j).map.At(position);
          sum += std::abs(turns - std::round(turns));
        }
        evidence.cycle_errors(i, j) = evidence.cycle_errors(j, i) = sum / kCycleSamples;
      }
    }
    return evidence;
  }

  // By the numbers of this order.
  std::optional<Mismatch> WorstMismatch() const {
    std::vector<double> landmarks;
    for (const auto& positions : positions_) landmarks.push_back(positions[tree_.root]);
    return FindMismatch(maps_, landmarks, order_);
  }

 private:
  struct ComparedPair {
    PairWeights weights;
    OutlineMap map;
    std::vector<double> starts;
  };
  const ComparedPair& Pair(int i, int j) const { return pairs_[i * n_ + j]; }

  // The landmarks that both drawings mark, along drawing i.
  std::vector<Anchor> MarkedAnchors(int i, int j) const {
    std::vector<Anchor> anchors;
    for (const auto& on : marks_.on) {
      if (on[i] && on[j]) anchors.push_back({on[i]->position, on[j]->position});
    }
    std::sort(anchors.begin(), anchors.end(),
              [](const Anchor& a, const Anchor& b) { return a.on_a < b.on_a; });
    return anchors;
  }

  // True when the anchors, two at least, lie turned against each other on the two drawings, so that
  // these cannot both be upright.
  bool AreTurned(int i, int j, const std::vector<Anchor>& anchors) const {
    return anchors.size() >= 2 && std::abs(RotationOf(i, j, anchors)) > kUpright;
  }

  // True when the map goes from one drawing to the other by about a quarter turn.  A half turn is
  // more often a drawing's own symmetry.
  bool IsTurned(int i, int j, const OutlineMap& map) const {
    std::vector<Anchor> places;
    for (int k = 0; k < kCycleSamples; ++k) {
      const double position = static_cast<double>(k) / kCycleSamples;
      places.push_back({position, map.At(position)});
    }
    const double rotation = std::abs(RotationOf(i, j, places));
    return rotation > kUpright && rotation < std::numbers::pi - kUpright;
  }

  // The angle of the least-squares rotation between the two drawings' places.
  double RotationOf(int i, int j, const std::vector<Anchor>& anchors) const {
    Point sum_i = Point::Zero(), sum_j = Point::Zero();
    for (const Anchor& anchor : anchors) {
      sum_i += curves_[i].At(anchor.on_a);
      sum_j += curves_[j].At(anchor.on_b);
    }
    const double count = static_cast<double>(anchors.size());
    double cosine = 0.0, sine = 0.0;
    for (const Anchor& anchor : anchors) {
      const Point on_i = curves_[i].At(anchor.on_a) - sum_i / count;
      const Point on_j = curves_[j].At(anchor.on_b) - sum_j / count;
      cosine += on_i.dot(on_j);
      sine += on_i.x() * on_j.y() - on_i.y() * on_j.x();
    }
    return std::atan2(sine, cosine);
  }

  bool ComparePairs() {
    costs_ = Eigen::MatrixXd::Zero(n_, n_);
    // Marks say which way round a drawing is: without any, each may be the wrong way.
    if (marks_.on.empty()) mirrored_costs_ = Eigen::MatrixXd::Zero(n_, n_);
    pairs_.resize(static_cast<std::size_t>(n_) * n_);
    int done = 0;
    for (int i = 0; i < n_; ++i) {
      const OutlineCurve mirrored = curves_[i].Mirrored();
      for (int j = i + 1; j < n_; ++j, ++done) {
        if (IsCancelled(progress_)) return false;
        Report(progress_, kCoarseShare * 2.0 * done / (n_ * (n_ - 1.0)));
        const std::vector<Anchor> anchors = MarkedAnchors(i, j);
        PairWeights weights{options_.position_weight, 0.0, options_.stretch_weight,
                            options_.thickness_weight};
        if (AreTurned(i, j, anchors)) weights.position = 0.0;
        CoarseMatch match = MatchCoarsely(curves_[i], curves_[j], anchors, weights);
        if (options_.colour_weight > 0.0 && curves_[i].has_colours() && curves_[j].has_colours()) {
          PairWeights coloured = weights;
          coloured.colour = options_.colour_weight;
          CoarseMatch by_colour = MatchCoarsely(curves_[i], curves_[j], anchors, coloured);
          if (MeanColourDifference(curves_[i], curves_[j], by_colour.map) <
              options_.max_colour_difference) {
            weights = coloured;
            match = std::move(by_colour);
          }
        }
        if (anchors.empty() && weights.position > 0.0) {
          const PairWeights turned{0.0, 0.0, options_.stretch_weight, options_.thickness_weight};
          CoarseMatch freely = MatchCoarsely(curves_[i], curves_[j], {}, turned);
          if (freely.cost < kTurnedCopy * match.cost && IsTurned(i, j, freely.map)) {
            weights = turned;
            match = std::move(freely);
          } else if (auto loose = MatchMovedLimbs(curves_[i], curves_[j], match, weights)) {
            weights = loose->weights;
            match = std::move(loose->match);
          }
        }
        costs_(i, j) = costs_(j, i) = match.cost;
        if (marks_.on.empty()) {
          mirrored_costs_(i, j) = mirrored_costs_(j, i) =
              MatchCoarsely(mirrored, curves_[j], {}, weights).cost;
        }
        std::vector<double> back_starts;
        for (const double start : match.starts) back_starts.push_back(-start);
        pairs_[j * n_ + i] = {weights, match.map.Inverse(), std::move(back_starts)};
        pairs_[i * n_ + j] = {weights, std::move(match.map), std::move(match.starts)};
      }
    }
    tree_ = SpanningTree(costs_);
    return true;
  }

  OutlineMap Match(int a, int b, const std::vector<Anchor>& anchors) const {
    const ComparedPair& pair = Pair(a, b);
    const OutlineMap map = MatchSymmetrically(curves_[a], mirror_sums_[a], curves_[b],
                                              mirror_sums_[b], anchors, pair.starts, pair.weights)
                               .map;
    OutlineMap close =
        MatchClosely(curves_[a], sides_[a], curves_[b], sides_[b], anchors, map, pair.weights);
    if (!anchors.empty()) return close;
    return KeepSymmetry(map, mirror_sums_[a], mirror_sums_[b], std::move(close));
  }

  bool FillLandmarks() {
    const auto num_landmarks = marks_.on.size();
    if (num_landmarks == 0) return true;
    // Where the marks leave the order open, it is that on the root as the coarse matches see it.
    std::vector<double> preferred(num_landmarks);
    for (std::size_t l = 0; l < num_landmarks; ++l) {
      for (auto i = tree_.order.rbegin(); i != tree_.order.rend(); ++i) {
        if (!marks_.on[l][*i]) continue;
        const double position = marks_.on[l][*i]->position;
        preferred[l] = *i == tree_.root ? position : Pair(*i, tree_.root).map.At(position);
      }
    }
    auto order = FindCommonOrder(marks_, preferred);
    if (!order) order = FindCommonOrder(marks_, std::vector<double>(num_landmarks, 0.0));
    order_ = std::move(*order);

    bool cancelled = false;
    positions_ = CompleteLandmarks(marks_, order_, tree_,
                                   [&](int a, int b, const std::vector<Anchor>& anchors) {
                                     cancelled = cancelled || IsCancelled(progress_);
                                     return cancelled ? OutlineMap() : Match(a, b, anchors);
                                   });
    return !cancelled;
  }

  bool MatchAlongTree() {
    maps_.resize(n_);
    int done = 0;
    for (const int i : tree_.order) {
      if (IsCancelled(progress_)) return false;
      Report(progress_, kCoarseShare + (1.0 - kCoarseShare) * done++ / n_);
      const int parent = tree_.parent[i];
      if (parent < 0) continue;
      maps_[i] = maps_[parent].Then(Match(parent, i, CommonAnchors(order_, positions_, parent, i)));
    }
    return true;
  }

  const std::vector<OutlineCurve> curves_;
  const Marks marks_;
  const MatchingOptions& options_;
  Progress* const progress_;
  const int n_;
  const std::vector<StrokeSides> sides_;
  const std::vector<std::vector<double>> mirror_sums_;

  std::vector<ComparedPair> pairs_;  // n x n, row i to column j
  Eigen::MatrixXd costs_;
  Eigen::MatrixXd mirrored_costs_;
  MatchingTree tree_;
  std::vector<int> order_;  // of the landmarks around every outline
  LandmarkPositions positions_;
  std::vector<OutlineMap> maps_;  // from the root's outline to each
};

// The drawings sorted by what they are, so that the caller's order decides nothing.
std::vector<int> CanonicalOrder(std::span<const MatchingShape> shapes, const Marks& marks) {
  std::vector<std::vector<double>> keys;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto& [name, outline, colours] = shapes[i];
    std::vector<double>& key = keys.emplace_back(outline.data(), outline.data() + outline.size());
    key.insert(key.end(), colours.data(), colours.data() + colours.size());
    for (const auto& on : marks.on) key.push_back(on[i] ? on[i]->position : -1.0);
  }
  std::vector<int> order(shapes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keys[a] < keys[b]; });
  return order;
}

// Entry k of the result is entry order[k] of `values`.
template <typename T>
std::vector<T> Reordered(const std::vector<T>& values, const std::vector<int>& order) {
  std::vector<T> result;
  for (const int k : order) result.push_back(values[k]);
  return result;
}

Result<void> CheckCorners(std::span<const MatchingShape> shapes) {
  std::int64_t corners = 0;
  const MatchingShape* longest = &shapes[0];
  for (const MatchingShape& shape : shapes) {
    corners += shape.outline.rows();
    if (shape.outline.rows() > longest->outline.rows()) longest = &shape;
  }
  if (corners <= kMaxCorners) return {};
  return Error{ErrorCode::kOutlineTooLong,
               "the outlines have " + std::to_string(corners) + " points together, the longest '" +
                   longest->name + "' " + std::to_string(longest->outline.rows()) + "; at most " +
                   std::to_string(kMaxCorners) + " are matched: give rings of fewer points",
               {{"shapes['" + longest->name + "'].outline", "has too many points"}}};
}

}  // namespace

Result<void> CheckLandmarks(std::span<const MatchingShape> shapes,
                            std::span<const Landmark> landmarks, const MatchingOptions& options) {
  auto marks = PlaceLandmarks(shapes, CurvesOf(shapes), landmarks, options);
  if (!marks) return std::move(marks).error();
  return {};
}

Result<MatchedOutlines> MatchBoundaries(std::span<const MatchingShape> shapes,
                                        std::span<const Landmark> landmarks,
                                        const MatchingOptions& options, Progress* progress) {
  TRY(CheckCorners(shapes));
  std::vector<OutlineCurve> curves = CurvesOf(shapes);
  for (OutlineCurve& curve : curves) curve.MeasureThickness();
  Marks marks = TRY(PlaceLandmarks(shapes, curves, landmarks, options));
  const std::vector<int> order = CanonicalOrder(shapes, marks);
  for (auto& on : marks.on) on = Reordered(on, order);
  const std::vector<int> of_tuple = marks.of_tuple;

  GroupMatching matching(Reordered(curves, order), std::move(marks), options, progress);
  const Error cancelled{ErrorCode::kCancelled, "matching was cancelled", {}};
  if (!matching.Run()) return cancelled;

  CommonRows rows = matching.Rows();
  const auto missed = FindMissedCorners(rows.outlines);
  const MatchingEvidence evidence = matching.Evidence();
  const FlipProposal proposal = ProposeFlips(evidence);
  const std::vector<double> confidence = ConfidenceOf(evidence, proposal);
  MatchedOutlines result;
  result.outlines.resize(shapes.size());
  result.confidence.resize(shapes.size());
  result.proposal = {std::vector<bool>(shapes.size()), proposal.gain};
  for (std::size_t k = 0; k < order.size(); ++k) {
    const MatchingShape& shape = shapes[order[k]];
    const auto crossing = FindCrossing(rows.outlines[k], progress);
    if (IsCancelled(progress)) return cancelled;
    if (crossing) {
      return Error{
          ErrorCode::kOutlineNotSimple,
          "shape '" + shape.name + "': its outline passes itself closer than numbers can tell",
          {{"shapes['" + shape.name + "'].outline", "touches itself"}}};
    }
    result.outlines[order[k]] = std::move(rows.outlines[k]);
    result.confidence[order[k]] = confidence[k];
    result.proposal.flips[order[k]] = proposal.flips[k];
  }
  if (const auto mismatch = matching.WorstMismatch()) {
    const auto [first, second] = std::minmax(order[mismatch->first], order[mismatch->second]);
    result.mismatch = Mismatch{first, second, mismatch->share, {}};
    for (const int landmark : mismatch->landmarks) {
      const auto tuple = std::find(of_tuple.begin(), of_tuple.end(), landmark);
      result.mismatch->landmarks.push_back(static_cast<int>(tuple - of_tuple.begin()));
    }
    std::sort(result.mismatch->landmarks.begin(), result.mismatch->landmarks.end());
  }
  if (missed) {
    result.missed_corners = MissedCorners{order[missed->first], order[missed->second],
                                          missed->count, missed->on_first, missed->on_second};
    if (result.missed_corners->first > result.missed_corners->second) {
      std::swap(result.missed_corners->first, result.missed_corners->second);
      std::swap(result.missed_corners->on_first, result.missed_corners->on_second);
    }
  }
  for (const int landmark : of_tuple) {
    result.landmark_rows.push_back(rows.landmark_rows[landmark]);
  }
  return result;
}

}  // namespace posespace
