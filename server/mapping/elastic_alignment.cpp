// SPDX-License-Identifier: Apache-2.0
#include "mapping/elastic_alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace posespace {

Unlikeness SquaredDistances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Unlikeness distances = -2.0 * a * b.transpose();
  distances.colwise() += a.rowwise().squaredNorm();
  distances.rowwise() += b.rowwise().squaredNorm().transpose();
  return distances.cwiseMax(0.0);
}

AlignmentBand WholeBlock(const Unlikeness& unlikeness, int intervals, int shift) {
  return {intervals, unlikeness.data() + shift, unlikeness.cols(),
          std::vector<int>(intervals + 1, 0), intervals + 1};
}

ElasticProgramme::ElasticProgramme(int max_step, double stretch_weight) {
  for (int a = 1; a <= max_step; ++a) {
    for (int b = 1; b <= max_step; ++b) {
      if (std::gcd(a, b) != 1) continue;
      const double log_slope = std::log(static_cast<double>(b) / a);
      steps_.push_back({a, b, stretch_weight * log_slope * log_slope});
    }
  }
}

// Row by row; within a row each step is one vectorisable loop over the columns that it reaches.
std::vector<double> ElasticProgramme::Fill(const AlignmentBand& band) const {
  const int m = band.intervals;
  std::vector<double> best(static_cast<std::size_t>(m + 1) * band.width,
                           std::numeric_limits<double>::infinity());
  best[0] = 0.0;
  for (int row = 1; row <= m; ++row) {
    const int low = band.low[row];
    double* const now = best.data() + static_cast<std::ptrdiff_t>(row) * band.width;
    const double* const cost_now = band.values + row * band.stride;
    for (const auto& [rows, columns, stretch] : steps_) {
      const int from = row - rows;
      if (from < 0) continue;
      const int from_low = band.low[from];
      const int first = std::max(low, from_low + columns);
      const int last = std::min(low + band.width, from_low + columns + band.width);
      const double weight = (rows + columns) / (2.0 * m);
      // Indexed by the column reached.
      const double* const before =
          best.data() + static_cast<std::ptrdiff_t>(from) * band.width - from_low - columns;
      const double* const cost_before = band.values + from * band.stride - from_low - columns;
      for (int column = first; column < last; ++column) {
        const double unlikeness = 0.5 * (cost_before[column] + cost_now[column - low]);
        const double via = before[column] + weight * (unlikeness + stretch);
        now[column - low] = via < now[column - low] ? via : now[column - low];
      }
    }
  }
  return best;
}

double ElasticProgramme::Cost(const AlignmentBand& band) const { return Fill(band).back(); }

Alignment ElasticProgramme::Align(const AlignmentBand& band) const {
  const int m = band.intervals;
  const std::vector<double> best = Fill(band);
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row) * band.width + (column - band.low[row]);
  };
  const auto cost = [&](int row, int column) {
    return band.values[row * band.stride + (column - band.low[row])];
  };
  Alignment alignment{best.back(), {{m, m}}};
  for (int row = m, column = m; row > 0;) {
    double least = std::numeric_limits<double>::infinity();
    std::array<int, 2> start{0, 0};
    for (const auto& [rows, columns, stretch] : steps_) {
      const int r = row - rows, c = column - columns;
      if (r < 0 || c < band.low[r] || c >= band.low[r] + band.width) continue;
      const double unlikeness = 0.5 * (cost(r, c) + cost(row, column));
      const double via = best[index(r, c)] + (rows + columns) / (2.0 * m) * (unlikeness + stretch);
      if (via < least) {
        least = via;
        start = {r, c};
      }
    }
    row = start[0];
    column = start[1];
    alignment.path.push_back(start);
  }
  std::reverse(alignment.path.begin(), alignment.path.end());
  return alignment;
}

}  // namespace posespace
