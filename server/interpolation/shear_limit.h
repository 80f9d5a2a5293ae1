// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_SHEAR_LIMIT_H_
#define POSESPACE_INTERPOLATION_SHEAR_LIMIT_H_

#include <Eigen/Core>
#include <algorithm>

namespace posespace {

enum class ShearLimit {
  kBand,     // identity on [b, 1 - b], C1 rounding at the ends, b = 0.1: ordinary in-betweens stay
  kHermite,  // the paper's cubic 3t^2 - 2t^3
  kOff,      // raw weights; extrapolation may fold
};

// phi(t): maps any weight into [0, 1], C1, with phi(0) = 0, phi(1) = 1 and zero slope at both.
inline double LimitWeight(double t, ShearLimit limit) {
  switch (limit) {
    case ShearLimit::kOff:
      return t;
    case ShearLimit::kHermite: {
      const double x = std::clamp(t, 0.0, 1.0);
      return x * x * (3.0 - 2.0 * x);
    }
    case ShearLimit::kBand: {
      constexpr double kBandWidth = 0.1;
      const auto rise = [](double s) {  // on [0, b]: b (2 x^2 - x^3), x = s / b
        const double x = s / kBandWidth;
        return kBandWidth * x * x * (2.0 - x);
      };
      if (t <= 0.0) return 0.0;
      if (t >= 1.0) return 1.0;
      if (t < kBandWidth) return rise(t);
      if (t > 1.0 - kBandWidth) return 1.0 - rise(1.0 - t);
      return t;
    }
  }
  return t;
}

// w' = phi(w) / sum phi(w): what stretch and texture are blended with, while rotations use w.
// For weights that sum to one some weight is >= 1/N, so the sum is positive.
// Follows Baxter, Barla, Anjyo 2009, section 4.2, "Shear limiting".
inline Eigen::VectorXd LimitedWeights(const Eigen::VectorXd& weights, ShearLimit limit) {
  if (limit == ShearLimit::kOff) return weights;
  Eigen::VectorXd limited = weights.unaryExpr([&](double t) { return LimitWeight(t, limit); });
  return limited / limited.sum();
}

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_SHEAR_LIMIT_H_
