// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MATCHING_ARCS_H_
#define POSESPACE_MAPPING_MATCHING_ARCS_H_

#include <Eigen/Core>
#include <vector>

#include "mapping/elastic_alignment.h"
#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"

namespace posespace {

// What makes two places of two outlines unlike, as in MatchingOptions; a weight of 0 leaves
// colours or thickness out.
struct PairWeights {
  double position;
  double colour;
  double stretch;
  double thickness;
};

// A position on each of two outlines that are the same place.
struct Anchor {
  double on_a;
  double on_b;
};

// The part of both outlines from one anchor to the next, to be sampled evenly on each.
struct Arc {
  Anchor begin;
  double length_a;  // turns
  double length_b;
};

// The arcs between anchors in their common cyclic order; one of a whole turn when there is but one
// anchor.  Requires at least one.
std::vector<Arc> ArcsBetween(const std::vector<Anchor>& anchors);

// How many intervals an arc is divided into where a whole turn has `samples_per_turn`.
int IntervalsOf(const Arc& arc, int samples_per_turn);

// The ends of `intervals` equal intervals, intervals + 1 positions.
std::vector<double> Samples(double begin, double length, int intervals);

// What places look like, one row each: OutlineCurve::Features, then thickness and colours when
// they count.  Squared distances between rows of two outlines are weighted unlikeness.
Eigen::MatrixXd FeaturesOf(const OutlineCurve& curve, const std::vector<double>& positions,
                           const PairWeights& weights);

// A map under construction from alignments of consecutive arcs.
class ArcsToMap {
 public:
  void Append(const Arc& arc, const Alignment& alignment, int intervals);

  // What was appended, closed after one turn.
  OutlineMap Map() &&;

 private:
  std::vector<double> from_;
  std::vector<double> to_;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MATCHING_ARCS_H_
