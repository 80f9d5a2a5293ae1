// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_INTERPOLATION_SAMPLE_MESHES_H_
#define POSESPACE_TESTS_INTERPOLATION_SAMPLE_MESHES_H_

#include <array>
#include <functional>
#include <random>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Where a pose puts a point of the undeformed mesh.
using Deformation = std::function<Point(const Point&)>;

// A grid of columns x rows squares of the given side, [0, columns side] x [-h, h] with h half its
// height, each cut in two.
CompatibleMesh StripMesh(int columns, int rows, double side, const std::vector<Deformation>& poses);

// The ring 0.5 <= radius <= 1.
CompatibleMesh AnnulusMesh(int spokes, int rings, const std::vector<Deformation>& poses);

// The plus of five squares [-1, 1]^2, [1, 4] x [-1, 1] and so on: a body with four limbs.
CompatibleMesh PlusMesh(int cells_per_unit, const std::vector<Deformation>& poses);

// Rolls the x axis into a circle that turns by `angle` over the first `length`.
Deformation Bent(double length, double angle);

// Turns around (0, 0) by `angle`, then moves.
Deformation Moved(double angle, const Point& shift);

// Rolls a strip of length 40 up: its heading turns by 5 pi, tighter towards the inner end, so that
// the spiral does not touch itself.
Point RolledUp(const Point& p);

// Bends the limbs of a PlusMesh by four angles each of which spreads evenly over the limb, and
// makes each longer by a factor.
Deformation WithLimbs(const std::array<double, 4>& angles, const std::array<double, 4>& lengths);

// The four poses of a PlusMesh with limbs bent at random by at most `most` radians.
std::vector<Deformation> RandomLimbs(int num_poses, double most, std::mt19937* random);

// Uniform in [low, high), the same on every platform.
double Uniform(double low, double high, std::mt19937* random);

// Random weights that are not negative and sum to one.
Eigen::VectorXd RandomWeights(int count, std::mt19937* random);

// The root mean square over the edges of log(length / mean of the poses' lengths under weights).
double EdgeDistortion(const CompatibleMesh& mesh, const Points& vertices,
                      const Eigen::VectorXd& weights);

// The largest distance between rows.
double Apart(const Points& a, const Points& b);

}  // namespace posespace

#endif  // POSESPACE_TESTS_INTERPOLATION_SAMPLE_MESHES_H_
