// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_MAPPING_RINGS_H_
#define POSESPACE_TESTS_MAPPING_RINGS_H_

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/polygon.h"

// Rings to match and to simplify, and checks of rings that share no code with what they check.

namespace posespace {

// A repeatable sequence of numbers in [0, 1).
class Sequence {
 public:
  explicit Sequence(std::uint32_t seed) : state_(seed * 2654435761u % 2147483647u + 1) {}
  double operator()() { return (state_ = state_ * 48271ull % 2147483647ull) / 2147483647.0; }

 private:
  std::uint64_t state_;
};

inline Point RowOf(const Points& ring, Eigen::Index k) {
  return ring.row(k % ring.rows()).transpose();
}

// A figure of `limbs` limbs with n corners, of about `size` pixels: row k is at the same angle for
// every seed, limbs differ in length and the outline is rough.
inline Points Figure(int n, int limbs, double size, std::uint32_t seed) {
  Sequence next(seed);
  std::vector<double> lengths;
  for (int l = 0; l < limbs; ++l) lengths.push_back(0.3 + 0.7 * next());
  Points ring(n, 2);
  for (int k = 0; k < n; ++k) {
    const double turn = static_cast<double>(k) / n;
    const double limb = turn * limbs;
    const double phase = std::sin(std::numbers::pi * (limb - std::floor(limb)));
    const double radius =
        size * (0.35 + lengths[static_cast<int>(limb)] * phase * phase + 0.02 * next());
    const double angle = 2.0 * std::numbers::pi * turn;
    ring.row(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return ring;
}

// A strip wound up `turns` times: nothing like a star, with gaps as narrow as the strip.
inline Points Spiral(int corners_per_side, double turns, double roughness, std::uint32_t seed) {
  Sequence next(seed);
  Points ring(2 * corners_per_side, 2);
  for (int k = 0; k < corners_per_side; ++k) {
    const double along = static_cast<double>(k) / (corners_per_side - 1);
    const double angle = 2.0 * std::numbers::pi * turns * along;
    const double radius = 20.0 + 40.0 * turns * along;
    const Point direction(std::cos(angle), std::sin(angle));
    ring.row(k) = (radius + 10.0 + roughness * next()) * direction.transpose();
    ring.row(2 * corners_per_side - 1 - k) =
        (radius - 10.0 + roughness * next()) * direction.transpose();
  }
  return ring;
}

inline Points StartedAt(const Points& ring, int start) {
  Points result(ring.rows(), 2);
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    result.row(k) = ring.row((k + start) % ring.rows());
  }
  return result;
}

inline Points Turned(const Points& ring, double angle) {
  Eigen::Matrix2d rotation = Eigen::Rotation2Dd(angle).toRotationMatrix();
  return ring * rotation.transpose();
}

inline double DistanceToSegment(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm();
}

inline double DistanceToRing(const Point& p, const Points& ring) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    least = std::min(least, DistanceToSegment(p, RowOf(ring, k), RowOf(ring, k + 1)));
  }
  return least;
}

// The largest distance from densely sampled points of `ring` to `other`.
inline double FarthestFrom(const Points& ring, const Points& other) {
  constexpr int kSamplesPerEdge = 20;
  double most = 0.0;
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    for (int s = 0; s < kSamplesPerEdge; ++s) {
      const double t = static_cast<double>(s) / kSamplesPerEdge;
      const Point p = (1.0 - t) * RowOf(ring, k) + t * RowOf(ring, k + 1);
      most = std::max(most, DistanceToRing(p, other));
    }
  }
  return most;
}

// True when everything inside simple ring `inner` is inside or on simple ring `outer`: no corner of
// one is on the wrong side of the other, and no two edges pass through each other.
inline bool Encloses(const Points& outer, const Points& inner) {
  for (Eigen::Index k = 0; k < inner.rows(); ++k) {
    if (Locate(RowOf(inner, k), outer) < 0) return false;
  }
  for (Eigen::Index k = 0; k < outer.rows(); ++k) {
    if (Locate(RowOf(outer, k), inner) > 0) return false;
  }
  for (Eigen::Index i = 0; i < outer.rows(); ++i) {
    const Point a = RowOf(outer, i), b = RowOf(outer, i + 1);
    for (Eigen::Index j = 0; j < inner.rows(); ++j) {
      const Point c = RowOf(inner, j), d = RowOf(inner, j + 1);
      if (Orientation(a, b, c) * Orientation(a, b, d) < 0 &&
          Orientation(c, d, a) * Orientation(c, d, b) < 0) {
        return false;
      }
    }
  }
  return true;
}

// The row of `ring` that is exactly p, or -1.
inline int RowAt(const Points& ring, const Point& p) {
  for (int k = 0; k < ring.rows(); ++k) {
    if (ring(k, 0) == p.x() && ring(k, 1) == p.y()) return k;
  }
  return -1;
}

// Where the development drawings are, or an empty path when they are not beside the project.
inline std::filesystem::path ShapesFolder() {
  const char* given = std::getenv("POSESPACE_SHAPES");
  const std::filesystem::path folder = given != nullptr ? given : "../shared/shapes";
  return std::filesystem::exists(folder / "index.json") ? folder : std::filesystem::path();
}

// The outer ring of one of their outline files, positively oriented.
inline Points OuterRing(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto begin = text.find("[[", text.find("\"outer\""));
  std::string list = text.substr(begin, text.find("]]", begin) - begin);
  for (char& c : list) {
    if (c == '[' || c == ']' || c == ',') c = ' ';
  }
  std::istringstream numbers(list);
  std::vector<double> values;
  for (double value; numbers >> value;) values.push_back(value);
  Points ring = Eigen::Map<Points>(values.data(), static_cast<Eigen::Index>(values.size() / 2), 2);
  if (SignedArea(ring) < 0.0) ring = ring.colwise().reverse().eval();
  return ring;
}

// The outline files of a group, by name.
inline std::vector<std::filesystem::path> OutlineFiles(const std::filesystem::path& group) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(group)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_MAPPING_RINGS_H_
