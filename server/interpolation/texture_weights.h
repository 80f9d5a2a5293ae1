// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_TEXTURE_WEIGHTS_H_
#define POSESPACE_INTERPOLATION_TEXTURE_WEIGHTS_H_

#include <Eigen/Core>
#include <algorithm>
#include <utility>

namespace posespace {

// w'': weights for mixing the poses' pixels, from limited weights w' (shear_limit.h) in [0, 1].
//
// sigma in [0, 1] is the sharpness of the transition: 0 gives w' itself, 1 a step.  Each weight is
// compared with the two largest together, t_i = w'_i / (largest + second), so that the transition
// sharpens for any number of poses; for two poses this is the paper's formula.  Sums to one.
// Follows Baxter, Barla, Anjyo 2009, section 4.2, "Texture blending".
inline Eigen::VectorXd TextureWeights(const Eigen::VectorXd& limited, double sigma) {
  double largest = 0.0, second = 0.0;
  for (const double w : limited) {
    if (w > largest) {
      second = std::exchange(largest, w);
    } else {
      second = std::max(second, w);
    }
  }
  const auto step = [&](double t) {  // smoothstep from sigma/2 to 1 - sigma/2
    if (sigma >= 1.0) return t > 0.5 ? 1.0 : t < 0.5 ? 0.0 : 0.5;
    const double x = std::clamp((t - 0.5 * sigma) / (1.0 - sigma), 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
  };
  Eigen::VectorXd sharp = limited.unaryExpr(
      [&](double w) { return sigma * step(w / (largest + second)) + (1.0 - sigma) * w; });
  return sharp / sharp.sum();
}

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_TEXTURE_WEIGHTS_H_
