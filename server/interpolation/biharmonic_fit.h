// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BIHARMONIC_FIT_H_
#define POSESPACE_INTERPOLATION_BIHARMONIC_FIT_H_

#include <Eigen/Core>

#include "geometry/progress.h"
#include "geometry/result.h"
#include "interpolation/pose_lattice.h"

namespace posespace {

// Something for each pose (column) at a lattice's vertices (rows).
using LatticeData = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The functions of least energy over a lattice that are one at one pose and zero at the others.
//
// The energy is sum over edges omega_jk |J_j - J_k|^2 + eps sum over triangles area_j |J_j|^2, J_j
// the gradient in triangle j, omega_jk = edge length / distance of the triangles' centroids, eps =
// 1.5 / levelling^2: with these factors it does not depend on the lattice's spacing, and gradients
// outweigh curvature beyond `levelling`, a length in the lattice's unit.
//
// Returns 3 V x N: rows 3 v, 3 v + 1, 3 v + 2 are values, x and y slopes at vertex v.  Values of a
// vertex sum to one, slopes to zero.
//
// Fails     kCancelled, kInternal (levelling so far from the lattice's size that the energy is
//           singular in double).
// Follows   Baxter, Barla, Anjyo 2009, section 4.1, equations (1) and (2).
Result<LatticeData> FitBiharmonic(const PoseLattice& lattice, double levelling,
                                  Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BIHARMONIC_FIT_H_
