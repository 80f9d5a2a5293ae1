// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_ELASTIC_ALIGNMENT_H_
#define POSESPACE_MAPPING_ELASTIC_ALIGNMENT_H_

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace posespace {

// How unlike sample i of one curve and sample j of another are; row i, column j.
using Unlikeness = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Squared distances between the rows of two feature matrices of equal width.
Unlikeness SquaredDistances(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// The part of an unlikeness that an alignment may use: on row i the `width` columns from low[i] on,
// held at values[i * stride].  Views; does not own.
struct AlignmentBand {
  int intervals;  // M: rows and columns run from 0 to M
  const double* values;
  std::ptrdiff_t stride;
  std::vector<int> low;  // M + 1 of them, never falling; low[0] = 0, low[M] + width = M + 1
  int width;
};

// A whole (M + 1) x (M + 1) block of `unlikeness` with its corner at column `shift`.
AlignmentBand WholeBlock(const Unlikeness& unlikeness, int intervals, int shift = 0);

struct Alignment {
  double cost;
  std::vector<std::array<int, 2>> path;  // (row, column) from (0, 0) to (M, M)
};

// The monotone path from (0, 0) to (M, M) of least cost: a dynamic programme over steps (a, b),
// coprime and each at most `max_step`, of cost
//   (a + b) / 2M ((unlikeness at start + at end) / 2 + stretch_weight ln(b / a)^2).
// Every path is strictly increasing in both, with slope between 1 / max_step and max_step.
// Immutable; share freely.
class ElasticProgramme {
 public:
  ElasticProgramme(int max_step, double stretch_weight);

  double Cost(const AlignmentBand& band) const;
  Alignment Align(const AlignmentBand& band) const;

 private:
  struct Step {
    int rows, columns;
    double stretch;
  };
  std::vector<double> Fill(const AlignmentBand& band) const;

  std::vector<Step> steps_;
};

}  // namespace posespace

#endif  // POSESPACE_MAPPING_ELASTIC_ALIGNMENT_H_
