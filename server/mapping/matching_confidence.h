// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MATCHING_CONFIDENCE_H_
#define POSESPACE_MAPPING_MATCHING_CONFIDENCE_H_

#include <Eigen/Core>
#include <vector>

#include "mapping/boundary_matching.h"

namespace posespace {

// What speaks for and against the matches of N drawings; all matrices N x N and symmetric.
struct MatchingEvidence {
  Eigen::MatrixXd costs;           // of matching each pair
  Eigen::MatrixXd mirrored_costs;  // with one of the two mirrored; empty: not in question
  Eigen::MatrixXd cycle_errors;    // mean |direct - composed|, turns
};

// The flips of drawings that make the sum of the pairs' costs least; none when they gain less than
// FlipProposal says or the evidence has no mirrored costs.  The larger group stays, and of equal
// groups that of drawing 0.
FlipProposal ProposeFlips(const MatchingEvidence& evidence);

// How clear the matching of each drawing is, in (0, 1]; below 0.5 a person should look at it.  A
// drawing is doubtful when it is unlike its group, when matching it directly and by way of others
// disagree, or when it would fit its group better mirrored.
std::vector<double> ConfidenceOf(const MatchingEvidence& evidence, const FlipProposal& proposal);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MATCHING_CONFIDENCE_H_
