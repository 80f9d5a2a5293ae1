// SPDX-License-Identifier: Apache-2.0
#include "mapping/map_judgement.h"

#include <cmath>
#include <vector>

namespace posespace {
namespace {

// Every group of the fifty real ones that is right by position alone stays right with kThickness
// from 0.06 to 0.15, kPlace from 0.8 to 3 and kPlaceLimit from 0.2 to 0.45, one changed at a time;
// that which comes right by judging does so with all of these but kThickness below 0.1.  With
// kPlace 1.2, symmetric drawings beside others that are not lose their symmetry; with 1.6 they keep
// it.
constexpr double kStretch = 0.05;
constexpr double kThickness = 0.1;
constexpr double kPlace = 2.0;
constexpr double kPlaceLimit = 0.3;  // spreads

}  // namespace

double JudgeMap(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map,
                double colour_weight) {
  const std::vector<double>&on_a = map.from(), &on_b = map.to();
  const Eigen::MatrixXd apart = a.Features(on_a, 1.0) - b.Features(on_b, 1.0);
  const Eigen::ArrayXd moved = apart.rightCols<2>().rowwise().squaredNorm();
  const Eigen::ArrayXd thicker = a.LogThickness(on_a) - b.LogThickness(on_b);
  Eigen::ArrayXd unlikeness = apart.leftCols(apart.cols() - 2).rowwise().squaredNorm();
  unlikeness += kThickness * thicker.square();
  unlikeness += kPlace * moved / (1.0 + moved / (kPlaceLimit * kPlaceLimit));
  if (colour_weight > 0.0) {
    unlikeness +=
        colour_weight * (a.Colours(on_a) - b.Colours(on_b)).rowwise().squaredNorm().array();
  }

  double cost = 0.0;
  for (std::size_t k = 0; k + 1 < on_a.size(); ++k) {
    const double along_a = on_a[k + 1] - on_a[k], along_b = on_b[k + 1] - on_b[k];
    const double log_slope = std::log(along_b / along_a);
    const auto row = static_cast<Eigen::Index>(k);
    cost += 0.5 * (along_a + along_b) *
            (0.5 * (unlikeness[row] + unlikeness[row + 1]) + kStretch * log_slope * log_slope);
  }
  return cost;
}

}  // namespace posespace
