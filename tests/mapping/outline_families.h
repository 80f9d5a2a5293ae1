// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_MAPPING_OUTLINE_FAMILIES_H_
#define POSESPACE_TESTS_MAPPING_OUTLINE_FAMILIES_H_

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "geometry/polygon.h"

// Families of simple, positively oriented rings of n rows, for tests of the mapping.  Each call
// draws another member; the generator alone decides which.

namespace posespace {

using Random = std::mt19937_64;

// In [0, 1), the same on every platform.
inline double Uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Star-shaped about the origin.
inline Points StarShaped(Random& random, int n) {
  Points ring(n, 2);
  for (int k = 0; k < n; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.8 * Uniform(random)) / n;
    const double radius = 0.3 + 0.7 * Uniform(random);
    ring.row(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return ring;
}

// Random points, uncrossed by reversing runs: the worst case, with nothing in common.
inline Points Uncrossed(Random& random, int n) {
  Points ring(n, 2);
  for (int k = 0; k < n; ++k) ring.row(k) << Uniform(random), Uniform(random);
  while (const auto crossing = FindCrossing(ring)) {
    for (int i = crossing->first + 1, j = crossing->second; i < j; ++i, --j) {
      ring.row(i).swap(ring.row(j));
    }
  }
  if (SignedArea(ring) < 0.0) ring = ring.colwise().reverse().eval();
  return ring;
}

// Teeth of random heights on a bar.
inline Points Comb(Random& random, int n) {
  Points ring(n, 2);
  ring.row(0) << 0.0, 0.0;
  ring.row(1) << n, 0.0;
  for (int k = 2; k < n; ++k) {
    const double x = n - (k - 1.5) * n / (n - 2);
    ring.row(k) << x, k % 2 == 0 ? 0.3 + 0.1 * Uniform(random) : 3.0 + 5.0 * Uniform(random);
  }
  return ring;
}

// A band wound 0.5 to 2.5 times; its two sides have equal numbers of rows.
inline Points Spiral(Random& random, int n) {
  const int outside = n / 2;
  const double turns = 0.5 + 2.0 * Uniform(random);
  Points ring(n, 2);
  for (int k = 0; k < n; ++k) {
    const double t = k < outside ? static_cast<double>(k) / (outside - 1)
                                 : static_cast<double>(n - 1 - k) / (n - outside - 1);
    const double radius = 1.0 + t * turns + (k < outside ? 0.25 : -0.25);
    const double angle = 2.0 * std::numbers::pi * turns * t;
    ring.row(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return ring;
}

// A body with n / 6 limbs of six rows each, every limb swung and stretched on its own.
inline Points Limbs(Random& random, int n) {
  const int limbs = std::max(3, n / 6);
  Points ring(6 * limbs, 2);
  for (int limb = 0; limb < limbs; ++limb) {
    const double step = 2.0 * std::numbers::pi / limbs, middle = step * limb;
    const double swing = 0.25 * step * (2.0 * Uniform(random) - 1.0);
    const double reach = 1.6 + 0.8 * Uniform(random);
    const double at[6][2] = {{1.0, -0.35 * step},
                             {0.5 * (1.0 + reach), 0.5 * swing - 0.2 * step},
                             {reach, swing - 0.12 * step},
                             {reach, swing + 0.12 * step},
                             {0.5 * (1.0 + reach), 0.5 * swing + 0.2 * step},
                             {1.0, 0.35 * step}};
    for (int k = 0; k < 6; ++k) {
      ring.row(6 * limb + k) << at[k][0] * std::cos(middle + at[k][1]),
          at[k][0] * std::sin(middle + at[k][1]);
    }
  }
  return ring;
}

// A ring of n / 3 corners with further rows on its edges: collinear but for rounding.
inline Points RowsOnEdges(Random& random, int n) {
  const int corners = std::max(3, n / 3);
  const Points outline = Uncrossed(random, corners);
  Points ring(n, 2);
  int row = 0;
  for (int k = 0; k < corners; ++k) {
    const int count = n * (k + 1) / corners - n * k / corners;
    for (int i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / count;
      ring.row(row++) = (1.0 - t) * outline.row(k) + t * outline.row((k + 1) % corners);
    }
  }
  return ring;
}

// An n x n square with n - 4 rows at random whole numbers along its sides: exactly collinear runs.
inline Points RowsOnSquare(Random& random, int n) {
  std::vector<int> stations;
  for (int s = 0; s < 4 * n; ++s) {
    if (s % n != 0) stations.push_back(s);
  }
  for (std::size_t k = stations.size() - 1; k > 0; --k) {
    std::swap(stations[k], stations[random() % (k + 1)]);
  }
  stations.resize(n - 4);
  for (int corner = 0; corner < 4; ++corner) stations.push_back(corner * n);
  std::sort(stations.begin(), stations.end());
  Points ring(n, 2);
  for (int k = 0; k < n; ++k) {
    const int side = stations[k] / n, along = stations[k] % n;
    const int x[4] = {along, n, n - along, 0}, y[4] = {0, along, n, n - along};
    ring.row(k) << x[side], y[side];
  }
  return ring;
}

struct OutlineFamily {
  std::string name;
  Points (*construct)(Random& random, int n);

  // With too few rows, or by rounding, a construction may fail to be simple; then a star it is.
  Points Draw(Random& random, int n) const {
    const Points ring = construct(random, n);
    return ring.rows() == n && IsSimple(ring) && SignedArea(ring) > 0.0 ? ring
                                                                        : StarShaped(random, n);
  }
};

inline const std::vector<OutlineFamily>& OutlineFamilies() {
  static const std::vector<OutlineFamily> families = {{"StarShaped", StarShaped},
                                                      {"Uncrossed", Uncrossed},
                                                      {"Comb", Comb},
                                                      {"Spiral", Spiral},
                                                      {"Limbs", Limbs},
                                                      {"RowsOnEdges", RowsOnEdges},
                                                      {"RowsOnSquare", RowsOnSquare}};
  return families;
}

inline std::vector<Points> DrawOutlines(const OutlineFamily& family, std::uint64_t seed, int count,
                                        int n, double scale = 1.0) {
  Random random(seed);
  std::vector<Points> outlines;
  for (int s = 0; s < count; ++s) outlines.push_back(scale * family.Draw(random, n));
  return outlines;
}

// Members of different families.
inline std::vector<Points> DrawMixedOutlines(std::uint64_t seed, int count, int n,
                                             double scale = 1.0) {
  Random random(seed);
  std::vector<Points> outlines;
  for (int s = 0; s < count; ++s) {
    const OutlineFamily& family = OutlineFamilies()[random() % OutlineFamilies().size()];
    outlines.push_back(scale * family.Draw(random, n));
  }
  return outlines;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_MAPPING_OUTLINE_FAMILIES_H_
