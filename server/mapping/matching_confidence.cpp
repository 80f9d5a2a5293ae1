// SPDX-License-Identifier: Apache-2.0
#include "mapping/matching_confidence.h"

#include <algorithm>
#include <cmath>

namespace posespace {
namespace {

// A score of 1 in each kind of evidence, and the score from which a person should look: of fifty
// groups of real drawings (tests/quality/judged_groups.json) it finds 13 of the 14 that are not
// right, and 5 of the other 36.
constexpr double kDoubtfulCost = 0.07;
constexpr double kDoubtfulCycle = 0.05;
constexpr double kDoubtfulGain = 0.06;
constexpr double kDoubtfulScore = 0.976;

// Added to the cost of each pair before costs are compared: among drawings that hardly differ a
// mirrored match may be cheaper by chance.
constexpr double kUnremarkableCost = 0.01;

constexpr double kLeastGain = 1.05;  // of flips worth proposing

double FlippedCost(const Eigen::MatrixXd& costs, const Eigen::MatrixXd& mirrored_costs,
                   const std::vector<bool>& flips) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < costs.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      sum += flips[i] == flips[j] ? costs(i, j) : mirrored_costs(i, j);
    }
  }
  return sum;
}

// The flips that make the sum of costs least, as far as flipping one drawing after another finds
// them.  The larger group stays, and of equal groups that of drawing 0.
std::vector<bool> CheapestFlips(const Eigen::MatrixXd& costs,
                                const Eigen::MatrixXd& mirrored_costs) {
  const int n = static_cast<int>(costs.rows());
  std::vector<bool> best(n, false);
  double least = FlippedCost(costs, mirrored_costs, best);
  // From each drawing flipped alone, and from none: flip whatever helps most until nothing helps.
  for (int first = -1; first < n; ++first) {
    std::vector<bool> flips(n, false);
    if (first >= 0) flips[first] = true;
    for (bool improved = true; improved;) {
      improved = false;
      int flip = -1;
      double gain = 0.0;
      for (int i = 0; i < n; ++i) {
        double change = 0.0;
        for (int j = 0; j < n; ++j) {
          if (j == i) continue;
          const double difference = mirrored_costs(i, j) - costs(i, j);
          change += flips[i] == flips[j] ? difference : -difference;
        }
        if (change < gain - 1e-12) {
          gain = change;
          flip = i;
        }
      }
      if (flip >= 0) {
        flips[flip] = !flips[flip];
        improved = true;
      }
    }
    const double cost = FlippedCost(costs, mirrored_costs, flips);
    if (cost < least) {
      least = cost;
      best = flips;
    }
  }
  const auto flipped = std::count(best.begin(), best.end(), true);
  if (2 * flipped > n || (2 * flipped == n && best[0])) best.flip();
  return best;
}

}  // namespace

FlipProposal ProposeFlips(const MatchingEvidence& evidence) {
  const auto n = evidence.costs.rows();
  const FlipProposal none{std::vector<bool>(n, false), 1.0};
  if (n < 2 || evidence.mirrored_costs.size() == 0) return none;
  FlipProposal proposal{CheapestFlips(evidence.costs, evidence.mirrored_costs), 1.0};
  const double least = FlippedCost(evidence.costs, evidence.mirrored_costs, proposal.flips);
  const double unremarkable = kUnremarkableCost * 0.5 * static_cast<double>(n * (n - 1));
  proposal.gain = (0.5 * evidence.costs.sum() + unremarkable) / (least + unremarkable);
  return proposal.gain >= kLeastGain ? proposal : none;
}

std::vector<double> ConfidenceOf(const MatchingEvidence& evidence, const FlipProposal& proposal) {
  const auto n = evidence.costs.rows();
  if (n < 2) return std::vector<double>(n, 1.0);

  std::vector<double> confidence;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double others = static_cast<double>(n - 1);
    double score = std::max(evidence.costs.row(i).sum() / others / kDoubtfulCost,
                            evidence.cycle_errors.row(i).sum() / others / kDoubtfulCycle);
    if (proposal.flips[i]) score = std::max(score, (proposal.gain - 1.0) / kDoubtfulGain);
    confidence.push_back(1.0 / (1.0 + std::pow(score / kDoubtfulScore, 2)));
  }
  return confidence;
}

}  // namespace posespace
