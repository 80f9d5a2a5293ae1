// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/ring_case.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <istream>
#include <limits>
#include <sstream>
#include <utility>

#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string Exact(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%a", value);
  return text;
}

int Below(Random& random, int end) { return static_cast<int>(random() % end); }
bool OneIn(Random& random, int count) { return Below(random, count) == 0; }

// A spread pair of wings with scalloped lower rims, between them a head with two ears.
const Points kBat = PointsOf(
    "0 40, 12 14, 30 4, 44 10, 47 2, 50 8, 53 2, 56 10, 70 4, 88 14, 100 40, 90 33, 82 46, 74 36,"
    " 66 52, 58 40, 50 66, 42 40, 34 52, 26 36, 18 46, 10 33");

Points Star(int tips, double inner) {
  Points ring(2 * tips, 2);
  for (int k = 0; k < 2 * tips; ++k) {
    const double angle = std::numbers::pi * k / tips, radius = k % 2 == 0 ? 50.0 : inner;
    ring.row(k) << 50.0 + radius * std::sin(angle), 50.0 - radius * std::cos(angle);
  }
  return ring;
}

// A bar bent by up to 300 degrees.
Points BentBar(Random& random, int n) {
  const double bend = (2.0 * Uniform(random) - 1.0) * 5.2 + 0.01;
  const double radius = 10.0 / bend;
  const int side = std::max(2, n / 2);
  Points ring(2 * side, 2);
  for (int k = 0; k < side; ++k) {
    const double t = static_cast<double>(k) / (side - 1), angle = bend * t;
    for (const auto& [row, offset] : {std::pair(k, -0.4), std::pair(2 * side - 1 - k, 0.4)}) {
      const double r = radius - offset;
      ring.row(row) << r * std::sin(angle), radius - r * std::cos(angle);
    }
  }
  return ring;
}

Points AnyRing(Random& random) {
  const int n = 3 + Below(random, OneIn(random, 4) ? 90 : 30);
  switch (Below(random, 10)) {
    case 0:
      return kBat;
    case 1:
      return Star(3 + Below(random, 12), 1.0 + 48.0 * Uniform(random));
    case 2:
      return BentBar(random, n);
    default: {
      const OutlineFamily& family = OutlineFamilies()[Below(random, 7)];
      return family.Draw(random, std::max(6, n));
    }
  }
}

double SizeOf(const Points& ring) {
  return (ring.colwise().maxCoeff() - ring.colwise().minCoeff()).maxCoeff();
}

Points WithRow(const Points& ring, int after, const Point& point) {
  Points more(ring.rows() + 1, 2);
  more << ring.topRows(after + 1), point.transpose(), ring.bottomRows(ring.rows() - after - 1);
  return more;
}

// One trouble, somewhere on the ring.
Points Spoilt(Random& random, const Points& ring) {
  const int n = static_cast<int>(ring.rows()), k = Below(random, n);
  const Point a = ring.row(k), b = ring.row((k + 1) % n);
  const Point outward = Point(b.y() - a.y(), a.x() - b.x());
  Points spoilt = ring;
  switch (Below(random, 8)) {
    case 0:  // a run in line
      for (const double t : {0.75, 0.5, 0.25}) spoilt = WithRow(spoilt, k, (1.0 - t) * a + t * b);
      return spoilt;
    case 1:  // a near duplicate
      return WithRow(ring, k, a + std::pow(10.0, -3.0 - 12.0 * Uniform(random)) * (b - a));
    case 2:  // a duplicate
      return WithRow(ring, k, a);
    case 3:  // a spike, as thin as numbers allow
      return WithRow(WithRow(ring, k, 0.5 * (a + b) + (0.1 + Uniform(random)) * outward), k,
                     (0.5 - std::pow(10.0, -1.0 - 9.0 * Uniform(random))) * a +
                         (0.5 + std::pow(10.0, -1.0 - 9.0 * Uniform(random))) * b);
    case 4: {  // a zigzag
      const double depth = std::pow(10.0, -1.0 - 6.0 * Uniform(random));
      for (int step = 9; step >= 1; --step) {
        const double t = step / 10.0;
        spoilt = WithRow(spoilt, k, (1.0 - t) * a + t * b + (step % 2 ? depth : -depth) * outward);
      }
      return spoilt;
    }
    case 5:  // a corner moved anywhere: most often it crosses
      spoilt.row(k) +=
          SizeOf(ring) * Eigen::RowVector2d(Uniform(random) - 0.5, Uniform(random) - 0.5);
      return spoilt;
    case 6:  // a corner moved next to another
      spoilt.row(k) = ring.row(Below(random, n)) +
                      1e-9 * SizeOf(ring) * Eigen::RowVector2d(Uniform(random), Uniform(random));
      return spoilt;
    default:  // whole numbers
      return (ring.array() * (20.0 / SizeOf(ring))).round().matrix();
  }
}

}  // namespace

std::string TextOf(const RingCase& input) {
  std::string text;
  for (const Points& ring : input.rings) {
    text += "ring";
    for (Eigen::Index k = 0; k < ring.rows(); ++k) {
      text += ' ' + Exact(ring(k, 0)) + ' ' + Exact(ring(k, 1));
    }
    text += '\n';
  }
  for (const Landmark& landmark : input.landmarks) {
    text += "landmark";
    for (std::size_t i = 0; i < landmark.points.size(); ++i) {
      if (!landmark.points[i]) continue;
      const Point& p = *landmark.points[i];
      text += ' ' + std::to_string(i) + ':' + Exact(p.x()) + ',' + Exact(p.y());
    }
    text += '\n';
  }
  return text;
}

RingCase CaseOf(std::istream& in) {
  RingCase input;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "ring") {
      std::vector<double> values;
      while (words >> word) values.push_back(std::strtod(word.c_str(), nullptr));
      input.rings.emplace_back(
          Eigen::Map<Points>(values.data(), static_cast<Eigen::Index>(values.size() / 2), 2));
    } else if (word == "landmark") {
      std::vector<std::optional<Point>>& points = input.landmarks.emplace_back().points;
      points.resize(input.rings.size());
      while (words >> word) {
        char* at = nullptr;
        const auto drawing = std::strtoul(word.c_str(), &at, 10);
        const double x = std::strtod(at + 1, &at), y = std::strtod(at + 1, &at);
        points.at(drawing) = Point(x, y);
      }
    }
  }
  return input;
}

RingCase DrawRings(Random& random) {
  RingCase input;
  const int count = 2 + Below(random, OneIn(random, 4) ? 7 : 2);
  for (int s = 0; s < count; ++s) {
    Points ring = AnyRing(random);
    ring *= 100.0 / SizeOf(ring);
    while (OneIn(random, 3)) ring = Spoilt(random, ring);
    if (OneIn(random, 4)) ring *= std::pow(10.0, 12.0 * Uniform(random) - 6.0);
    if (OneIn(random, 6)) ring.rowwise() += Eigen::RowVector2d(1e5, -1e5) * Uniform(random);
    if (OneIn(random, 5)) ring = ring.colwise().reverse().eval();
    input.rings.push_back(std::move(ring));
  }
  return input;
}

RingCase DrawLandmarks(Random& random) {
  RingCase input;
  const int count = 1 + Below(random, 5);
  for (int s = 0; s < count; ++s) {
    const Points ring = AnyRing(random);
    input.rings.push_back(ring * (100.0 / SizeOf(ring)));
  }
  for (int more = 1 + Below(random, 6); more > 0; --more) {
    Landmark landmark;
    landmark.points.resize(count);
    for (int s = 0; s < count; ++s) {
      const Points& ring = input.rings[s];
      if (OneIn(random, 3)) continue;
      const auto n = static_cast<int>(ring.rows());
      const int k = Below(random, n);
      const Point a = ring.row(k), b = ring.row((k + 1) % n);
      double t = OneIn(random, 2) ? 0.0 : Uniform(random);  // on a corner, or beside it
      if (OneIn(random, 6)) t = std::pow(10.0, -16.0 * Uniform(random));
      Point p = (1.0 - t) * a + t * b;
      if (OneIn(random, 3)) p += 4.0 * Point(Uniform(random) - 0.5, Uniform(random) - 0.5);
      if (OneIn(random, 40)) p = 1e3 * Point(Uniform(random), Uniform(random));
      if (OneIn(random, 80)) p.x() = kNan;
      landmark.points[s] = p;
    }
    if (OneIn(random, 5) && !input.landmarks.empty()) {  // some marks of an earlier one, again
      const Landmark& earlier = input.landmarks[Below(random, std::ssize(input.landmarks))];
      for (int s = 0; s < count; ++s) {
        if (OneIn(random, 2)) landmark.points[s] = earlier.points[s];
      }
    }
    bool any = false;
    for (const auto& point : landmark.points) any = any || point.has_value();
    if (any) input.landmarks.push_back(std::move(landmark));
  }
  return input;
}

}  // namespace posespace
