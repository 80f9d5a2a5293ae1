// SPDX-License-Identifier: Apache-2.0
#include "interpolation/clough_tocher.h"

namespace posespace {
namespace {

// Shares are found backwards: the Bernstein weights of the ordinates around the point flow through
// each ordinate's definition down to the corners' values and gradients.
struct Backwards {
  const std::array<Point, 3>& corner;
  CornerShares shares{};

  // weight * (f_k + gradient_k . step): an ordinate on a corner's tangent plane.
  void Tangent(int k, const Point& step, double weight) {
    shares[k][0] += weight;
    shares[k][1] += weight * step.x();
    shares[k][2] += weight * step.y();
  }

  // weight * the ordinate a third of the way from corner i to `to`.
  void Third(int i, const Point& to, double weight) { Tangent(i, (to - corner[i]) / 3.0, weight); }

  // weight * the middle ordinate of the part beside edge ij.  With theta the place of the
  // centroid's foot on the edge, linearity of the normal derivative gives
  // b111 = theta b210 + (1 - theta) b120
  //        + (b201 - theta b300 - (1 - theta) b210 + b021 - theta b120 - (1 - theta) b030) / 2.
  void Middle(int i, int j, const Point& centroid, double weight) {
    const Point edge = corner[j] - corner[i];
    const double theta = (corner[j] - centroid).dot(edge) / edge.squaredNorm();
    Third(i, corner[j], weight * (1.5 * theta - 0.5));
    Third(j, corner[i], weight * (1.0 - 1.5 * theta));
    Third(i, centroid, 0.5 * weight);
    Third(j, centroid, 0.5 * weight);
    shares[i][0] -= 0.5 * weight * theta;
    shares[j][0] -= 0.5 * weight * (1.0 - theta);
  }

  // weight * the ordinate two thirds of the way from corner k to the centroid: C1 across the split
  // makes it the mean of its three neighbours.
  void Inner(int k, const Point& centroid, double weight) {
    const double third = weight / 3.0;
    Third(k, centroid, third);
    Middle(k, (k + 1) % 3, centroid, third);
    Middle((k + 2) % 3, k, centroid, third);
  }
};

}  // namespace

CornerShares CloughTocher(const std::array<Point, 3>& triangle,
                          const Eigen::Vector3d& barycentric) {
  // The part of the split that holds the point lies opposite the corner it is farthest from.
  int far = 0;
  for (int k = 1; k < 3; ++k) {
    if (barycentric[k] < barycentric[far]) far = k;
  }
  const int i = (far + 1) % 3, j = (far + 2) % 3;
  const double w = 3.0 * barycentric[far];  // barycentric coordinates in (corner i, j, centroid)
  const double u = barycentric[i] - barycentric[far], v = barycentric[j] - barycentric[far];
  const Point centroid = (triangle[0] + triangle[1] + triangle[2]) / 3.0;

  Backwards backwards{triangle};
  backwards.shares[i][0] += u * u * u;
  backwards.shares[j][0] += v * v * v;
  backwards.Third(i, triangle[j], 3.0 * u * u * v);
  backwards.Third(j, triangle[i], 3.0 * u * v * v);
  backwards.Third(i, centroid, 3.0 * u * u * w);
  backwards.Third(j, centroid, 3.0 * v * v * w);
  backwards.Middle(i, j, centroid, 6.0 * u * v * w);
  // The centroid's own ordinate is the mean of the three inner ones.
  const double central = w * w * w / 3.0;
  backwards.Inner(i, centroid, 3.0 * u * w * w + central);
  backwards.Inner(j, centroid, 3.0 * v * w * w + central);
  backwards.Inner(far, centroid, central);
  return backwards.shares;
}

}  // namespace posespace
