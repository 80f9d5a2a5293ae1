// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_RPC_SAMPLE_SHAPES_H_
#define POSESPACE_TESTS_RPC_SAMPLE_SHAPES_H_

#include <cmath>
#include <numbers>

#include "geometry/mesh.h"

namespace posespace {

// An ellipse of 24 corners about (100, 100): any two of them are easily matched and meshed.
inline Points EllipseOf(double half_width, double half_height) {
  constexpr int kCorners = 24;
  Points ring(kCorners, 2);
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kCorners;
    ring.row(k) << 100.0 + half_width * std::cos(angle), 100.0 + half_height * std::sin(angle);
  }
  return ring;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_RPC_SAMPLE_SHAPES_H_
