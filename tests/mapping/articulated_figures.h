// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_MAPPING_ARTICULATED_FIGURES_H_
#define POSESPACE_TESTS_MAPPING_ARTICULATED_FIGURES_H_

#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/polygon.h"
#include "tests/mapping/outline_families.h"

// Silhouettes of jointed figures in several poses, whose correspondence is known: row k is the same
// place in every pose.

namespace posespace {

// A limb grows from the body, tapers, and ends in a round tip.
struct Limb {
  double at;             // angle on the body where it grows, radians
  double length, width;  // of the body's radius
};

struct LimbPose {
  double swing;    // at the body, radians
  double bend;     // along the limb, radians in all
  double stretch;  // of its length
};

// The outline of a body of radius 1 with limbs, of 14 rows a limb and 6 between limbs.
inline Points Silhouette(const std::vector<Limb>& limbs, const std::vector<LimbPose>& pose) {
  constexpr int kAlong = 6;   // rows each side of a limb
  constexpr int kAround = 6;  // rows on the body before the next limb
  std::vector<Point> rows;
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    const Limb& limb = limbs[l];
    Point middle(0.9 * std::cos(limb.at), 0.9 * std::sin(limb.at));
    const double length = limb.length * pose[l].stretch;
    std::vector<Point> right, left;
    double heading = limb.at + pose[l].swing;
    for (int k = 0; k < kAlong; ++k) {
      const double along = static_cast<double>(k) / (kAlong - 1);
      const double half = 0.5 * limb.width * (1.0 - 0.4 * along);
      const Point across(-std::sin(heading), std::cos(heading));
      right.push_back(middle - half * across);
      left.push_back(middle + half * across);
      heading += pose[l].bend / (kAlong - 1);
      middle += length / (kAlong - 1) * Point(std::cos(heading), std::sin(heading));
    }
    const Point back = middle - length / (kAlong - 1) * Point(std::cos(heading), std::sin(heading));
    rows.insert(rows.end(), right.begin(), right.end());
    const Point ahead(std::cos(heading), std::sin(heading)), across(-ahead.y(), ahead.x());
    rows.push_back(back + 0.25 * limb.width * (ahead - 0.5 * across));
    rows.push_back(back + 0.25 * limb.width * (ahead + 0.5 * across));
    rows.insert(rows.end(), left.rbegin(), left.rend());

    const Limb& next = limbs[(l + 1) % limbs.size()];
    const double begin = limb.at + 0.6 * limb.width;
    const double end =
        next.at - 0.6 * next.width + (l + 1 == limbs.size() ? 2.0 * std::numbers::pi : 0.0);
    for (int k = 0; k < kAround; ++k) {
      const double angle = begin + (end - begin) * k / (kAround - 1);
      rows.emplace_back(std::cos(angle), std::sin(angle));
    }
  }
  Points ring(static_cast<Eigen::Index>(rows.size()), 2);
  for (std::size_t k = 0; k < rows.size(); ++k) ring.row(k) = rows[k].transpose();
  return ring;
}

// `count` poses of one figure of five limbs: each limb swings by up to 0.35, bends by up to 1.2
// radians and is 0.85 to 1.15 times as long, on its own.
inline std::vector<Points> ArticulatedPoses(Random& random, int count) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * Uniform(random);
  };
  std::vector<Limb> limbs;
  for (int l = 0; l < 5; ++l) {
    const double step = 2.0 * std::numbers::pi / 5;
    limbs.push_back({step * (l + between(-0.15, 0.15)), between(0.9, 2.6), between(0.25, 0.5)});
  }
  std::vector<Points> poses;
  while (static_cast<int>(poses.size()) < count) {
    std::vector<LimbPose> pose;
    for (int l = 0; l < 5; ++l) {
      pose.push_back({between(-0.35, 0.35), between(-1.2, 1.2), between(0.85, 1.15)});
    }
    const Points ring = Silhouette(limbs, pose);
    if (IsSimple(ring) && SignedArea(ring) > 0.0) poses.push_back(ring);
  }
  return poses;
}

// `count` masters of one letter, a curved stroke from hairline to black: thickness is 0.03 to 0.12
// of its length, swells along it by up to a third, and its two ends are cut straight.
inline std::vector<Points> GlyphMasters(Random& random, int count) {
  constexpr int kAlong = 60;  // rows each side
  const double curl = 1.0 + 1.5 * Uniform(random), phase = 6.0 * Uniform(random);
  const double wave = 2.0 * Uniform(random);
  std::vector<Points> masters;
  while (static_cast<int>(masters.size()) < count) {
    const double thickness = 0.03 + 0.09 * masters.size() / std::max(1, count - 1);
    const double swell = 0.3 * Uniform(random);
    const double change = 0.2 * (Uniform(random) - 0.5);
    Points ring(2 * kAlong, 2);
    Point middle(0.0, 0.0);
    for (int k = 0; k < kAlong; ++k) {
      const double t = static_cast<double>(k) / (kAlong - 1);
      const double heading = (1.0 + change) * (curl * t * 2.0 + wave * std::sin(5.0 * t + phase));
      const Point ahead(std::cos(heading), std::sin(heading)), across(-ahead.y(), ahead.x());
      const double half = 0.5 * thickness * (1.0 + swell * std::sin(6.0 * t));
      ring.row(k) = (middle - half * across).transpose();
      ring.row(2 * kAlong - 1 - k) = (middle + half * across).transpose();
      middle += ahead / (kAlong - 1);
    }
    if (!IsSimple(ring) || SignedArea(ring) <= 0.0) return GlyphMasters(random, count);
    masters.push_back(ring);
  }
  return masters;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_MAPPING_ARTICULATED_FIGURES_H_
